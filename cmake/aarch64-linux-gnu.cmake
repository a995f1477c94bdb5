# Toolchain file: compiles for 64-bit ARM on another machine with Debian's g++-aarch64-linux-gnu, and runs what was
# compiled with qemu-user where that is there. Libraries are those of the cross compiler only; `hwy_DIR` and the like
# name more.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_FIND_ROOT_PATH /usr/aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
find_program(KERF_QEMU NAMES qemu-aarch64 qemu-aarch64-static)
if(KERF_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${KERF_QEMU};-L;/usr/aarch64-linux-gnu)
endif()
