# cmake --install: headers, libraries, the program, and what find_package(kerf) and pkg-config need to find them.
# Everything is found relative to where it lies, so the installed folder may be moved.

set(KERF_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/kerf)

# kerf_install(TARGET SET FOLDER...): a library in the export set SET, with the headers of its folders.
function(kerf_install target set)
  set_target_properties(${target} PROPERTIES VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH ${KERF_ORIGIN})
  install(TARGETS ${target} EXPORT ${set} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
    LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  install(EXPORT ${set} NAMESPACE kerf:: DESTINATION ${KERF_CMAKE_DIR})
  foreach(folder ${ARGN})
    # simd.h and the parts of kernels are the library's own: they need Highway's headers, which users of Kerf need not
    # have; as the two about Embree need Embree's.
    # The folders within kerf/io are the insides of its readers, kerf/study/report those of the page.
    install(DIRECTORY kerf/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kerf FILES_MATCHING PATTERN "*.h"
      PATTERN simd.h EXCLUDE PATTERN wide_boxes.h EXCLUDE PATTERN quantised_boxes.h EXCLUDE PATTERN leaf_tests.h EXCLUDE
      PATTERN exact_test.h EXCLUDE PATTERN wide_stream.h EXCLUDE PATTERN child_keys.h EXCLUDE
      PATTERN box_overlap.h EXCLUDE PATTERN leaf_visits.h EXCLUDE PATTERN rays_in_flight.h EXCLUDE PATTERN wide_walk.h EXCLUDE
      PATTERN embree_calls.h EXCLUDE PATTERN embree_pass.h EXCLUDE
      REGEX "kerf/(io/[a-z]+|study/report)$" EXCLUDE)
  endforeach()
endfunction()

set(KERF_ORIGIN "\$ORIGIN")
if(APPLE)
  set(KERF_ORIGIN "@loader_path")
endif()

kerf_install(kerf kerf-targets base geometry references tree build layout trace choose scene)
install(FILES ${CMAKE_BINARY_DIR}/include/kerf/base/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/kerf/base)
if(TARGET kerf-render)
  kerf_install(kerf-render kerf-render-targets io render study)
endif()
if(TARGET kerf_cli)
  file(RELATIVE_PATH to_libraries /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set_target_properties(kerf_cli PROPERTIES INSTALL_RPATH ${KERF_ORIGIN}/${to_libraries})
endif()

# A static library leaves it to its users to link what it needs; a shared one names it itself.
get_target_property(kerf_type kerf TYPE)
set(KERF_FIND_DEPENDENCIES "")
set(KERF_RENDER_FIND_DEPENDENCIES "")
set(KERF_PC_REQUIRES libhwy)
if(KERF_TASKS STREQUAL "tbb")
  string(APPEND KERF_PC_REQUIRES ", tbb")
endif()
if(kerf_type STREQUAL "STATIC_LIBRARY")
  set(KERF_FIND_DEPENDENCIES "find_dependency(Threads)\nfind_dependency(hwy)")
  if(KERF_TASKS STREQUAL "tbb")
    string(APPEND KERF_FIND_DEPENDENCIES "\nfind_dependency(TBB)")
  endif()
  set(KERF_RENDER_FIND_DEPENDENCIES "find_dependency(fmt)")
  foreach(package yaml-cpp TinyGLTF assimp OpenEXR embree)
    if(${package}_FOUND)
      string(APPEND KERF_RENDER_FIND_DEPENDENCIES "\nfind_dependency(${package})")
    endif()
  endforeach()
endif()
configure_package_config_file(cmake/kerf-config.cmake.in ${CMAKE_BINARY_DIR}/cmake/kerf-config.cmake
  INSTALL_DESTINATION ${KERF_CMAKE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/cmake/kerf-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/cmake/kerf-config.cmake ${CMAKE_BINARY_DIR}/cmake/kerf-config-version.cmake
  DESTINATION ${KERF_CMAKE_DIR})

set(KERF_PC_LIBS ${CMAKE_THREAD_LIBS_INIT})
foreach(library ${CMAKE_CXX_IMPLICIT_LINK_LIBRARIES})  # for programs that are linked by a C compiler
  if(library MATCHES "^(stdc\\+\\+|c\\+\\+)$")
    string(APPEND KERF_PC_LIBS " -l${library}")
  endif()
endforeach()
foreach(folder PREFIX LIBDIR INCLUDEDIR)
  set(KERF_PC_${folder} "\${prefix}/${CMAKE_INSTALL_${folder}}")
  if(IS_ABSOLUTE "${CMAKE_INSTALL_${folder}}")
    set(KERF_PC_${folder} ${CMAKE_INSTALL_${folder}})
  endif()
endforeach()
if(NOT IS_ABSOLUTE "${CMAKE_INSTALL_LIBDIR}")
  file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" to_prefix ${to_prefix})
  set(KERF_PC_PREFIX "\${pcfiledir}/${to_prefix}")
endif()
configure_file(cmake/kerf.pc.in ${CMAKE_BINARY_DIR}/cmake/kerf.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/cmake/kerf.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
