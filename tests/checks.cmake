# Tests that need no GoogleTest: of the package, the layers, the format.

# kerf_check(NAME LABELS COMMAND...): exit status 77 means skipped.
function(kerf_check name labels)
  add_test(NAME ${name} COMMAND ${ARGN})
  set(flags "")
  if(KERF_SANITIZE)
    set(flags -fsanitize=${KERF_SANITIZE})
  endif()
  set_tests_properties(${name} PROPERTIES LABELS "${labels}" SKIP_RETURN_CODE 77 TIMEOUT 900 ENVIRONMENT
    "KERF_SOURCE=${PROJECT_SOURCE_DIR};KERF_BUILD=${PROJECT_BINARY_DIR};KERF_VERSION=${PROJECT_VERSION};KERF_CMAKE=${CMAKE_COMMAND};KERF_CXX=${CMAKE_CXX_COMPILER};KERF_GENERATOR=${CMAKE_GENERATOR};KERF_MAKE=${CMAKE_MAKE_PROGRAM};KERF_SANITIZE_FLAGS=${flags}")
endfunction()

if(KERF_INSTALL)
  kerf_check(package.install small ${CMAKE_CURRENT_SOURCE_DIR}/package/install_test.sh)
  kerf_check(package.highway_only large ${CMAKE_CURRENT_SOURCE_DIR}/package/highway_only_test.sh)
endif()

if(Python3_Interpreter_FOUND)
  kerf_check(layers unit ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/check_layers.py)
  kerf_check(layers.self_test unit ${Python3_EXECUTABLE} ${CMAKE_CURRENT_SOURCE_DIR}/check_layers.py --self-test)
else()
  kerf_skipped_test(layers "no Python")
endif()
kerf_check(format large ${CMAKE_CURRENT_SOURCE_DIR}/check_format.sh)
if(NOT KERF_SANITIZE)  # nothing that the other builds do not have
  kerf_check(tidy large ${CMAKE_CURRENT_SOURCE_DIR}/check_tidy.sh --fifths ${PROJECT_BINARY_DIR})
  set_tests_properties(tidy PROPERTIES PROCESSORS 2 COST 700 TIMEOUT 2700)
endif()
