# What every target of the project is compiled with, the options, and the libraries that are optional.

set(KERF_TASKS auto CACHE STRING "Task back end: tbb, std (plain threads), or auto (tbb where it is found)")
set_property(CACHE KERF_TASKS PROPERTY STRINGS auto tbb std)
set(KERF_SANITIZE "" CACHE STRING "Sanitizers for -fsanitize, such as address,undefined or thread")
option(KERF_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(KERF_WERROR "Warnings are errors" ${PROJECT_IS_TOP_LEVEL})
option(KERF_PYTHON "Build the Python module" ${PROJECT_IS_TOP_LEVEL})
option(KERF_INSTALL "Make cmake --install install Kerf" ${PROJECT_IS_TOP_LEVEL})

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_ARCHIVE_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)

find_package(hwy REQUIRED)
find_package(Threads REQUIRED)
if(NOT KERF_TASKS STREQUAL "std")
  find_package(TBB QUIET)
  if(NOT TBB_FOUND AND KERF_TASKS STREQUAL "tbb")
    message(FATAL_ERROR "KERF_TASKS=tbb, but oneTBB was not found")
  endif()
endif()
if(TBB_FOUND)
  set(KERF_TASKS tbb)
else()
  message(STATUS "kerf: oneTBB not used, tasks run on std::thread")
  set(KERF_TASKS std)
endif()

# kerf_optional(PACKAGE WHAT) looks for an optional library and says what is switched off without it.
macro(kerf_optional package what)
  find_package(${package} QUIET)
  if(NOT ${package}_FOUND)
    message(STATUS "kerf: ${package} not found: no ${what}")
  endif()
endmacro()

# Debian's own Python is the one that Debian's numpy is for; another one may be ahead on PATH.
if(NOT DEFINED Python3_EXECUTABLE AND NOT DEFINED ENV{VIRTUAL_ENV} AND EXISTS /etc/debian_version)
  find_program(Python3_EXECUTABLE python3 PATHS /usr/bin NO_DEFAULT_PATH)
endif()
find_package(Python3 QUIET COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)

# kerf_skipped_test(NAME REASON) stands for a test that cannot be had here, so that it is skipped by name.
function(kerf_skipped_test name reason)
  if(KERF_TESTS)
    add_test(NAME ${name} COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${reason}")
    set_tests_properties(${name} PROPERTIES LABELS small SKIP_REGULAR_EXPRESSION "^skipped: ")
  endif()
endfunction()

add_library(kerf_flags INTERFACE)
# Fused multiply-adds would make two neighbours disagree about their shared edge.
target_compile_options(kerf_flags INTERFACE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow
  -Wno-missing-field-initializers
  # g++ 12 warns falsely about std::string and about a std::variant of vectors.
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict$<SEMICOLON>-Wno-maybe-uninitialized>)
if(KERF_WERROR)
  target_compile_options(kerf_flags INTERFACE -Werror)
endif()
if(KERF_SANITIZE)
  target_compile_options(kerf_flags INTERFACE -fsanitize=${KERF_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer -g1 -O1)
  target_link_options(kerf_flags INTERFACE -fsanitize=${KERF_SANITIZE})
endif()

configure_file(kerf/base/version.h.in ${CMAKE_BINARY_DIR}/include/kerf/base/version.h @ONLY)

# kerf_library(NAME): the include folders and flags that each of our libraries has, and the name kerf::NAME, which is
# the one it has after find_package(kerf) too.
function(kerf_library name)
  add_library(kerf::${name} ALIAS ${name})
  target_include_directories(${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}>
    $<BUILD_INTERFACE:${CMAKE_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${name} PUBLIC cxx_std_20)
  target_link_libraries(${name} PRIVATE $<BUILD_INTERFACE:kerf_flags>)
endfunction()
