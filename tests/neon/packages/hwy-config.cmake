# Highway of this machine for another one: its headers are the same for all, and of its library Kerf needs nothing where
# there is one instruction set only.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/highway)
file(CREATE_LINK ${KERF_HIGHWAY_HEADERS}/hwy ${CMAKE_BINARY_DIR}/highway/hwy SYMBOLIC)
add_library(hwy::hwy INTERFACE IMPORTED)
target_include_directories(hwy::hwy INTERFACE ${CMAKE_BINARY_DIR}/highway)
