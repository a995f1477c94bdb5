# Runs PROGRAM, which must succeed and print something that matches OUTPUT.
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE printed RESULT_VARIABLE result)
message("${printed}")
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${PROGRAM}: ${result}")
endif()
if(NOT printed MATCHES "${OUTPUT}")
  message(FATAL_ERROR "what it printed does not match: ${OUTPUT}")
endif()
