# SPDX-License-Identifier: Apache-2.0
# Toolchain for 64-bit ARM: Debian's cross compiler, against the Debian in SEGUE_ARM64_ROOT (made by tools/arm64_root). What the
# build has to run of its own programs, such as the one that describes components, runs in QEMU.
set(SEGUE_ARM64_ROOT ${CMAKE_CURRENT_LIST_DIR}/../build/arm64-root CACHE PATH "Folder with the libraries of a Debian for arm64")
cmake_path(ABSOLUTE_PATH SEGUE_ARM64_ROOT NORMALIZE OUTPUT_VARIABLE root)
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES SEGUE_ARM64_ROOT)

set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT ${root})
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${root})
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)

# Programs are this computer's; all else is the other Debian's.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${root})
set(ENV{PKG_CONFIG_LIBDIR} ${root}/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/pkgconfig:${root}/usr/share/pkgconfig)
