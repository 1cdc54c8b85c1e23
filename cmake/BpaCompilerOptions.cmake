# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# One place for what every target of the project is compiled with.

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Without these ccache does not keep what was compiled with a precompiled header.
  set(ccache ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
  set(CMAKE_C_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
  set(CMAKE_CXX_COMPILER_LAUNCHER ${ccache})
endif()

set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)

option(BPA_UNITY "Compile several files of a room at once" ON)

# bpa_compile_together(TARGET): several files at once, since parsing Eigen, OpenCV, CLI11 or JSON takes
# longer than most files themselves. The preset asan compiles each file by itself, which shows includes
# that are missing.
function(bpa_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${BPA_UNITY} UNITY_BUILD_BATCH_SIZE 8)
endfunction()

# bpa_compile_cold(TARGET): command lines, printing and tests, which take twice as long to compile with
# -O3 and do little themselves.
function(bpa_compile_cold target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

# bpa_compile_options(TARGET): language level, warnings, sanitizers.
function(bpa_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE
    -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-align
    -Woverloaded-virtual
    -fno-math-errno -fno-trapping-math -ffp-contract=off)
  # GCC 12 warns of "text" + std::string where it inlines far enough (GCC bug 105651).
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(BPA_SANITIZE_ADDRESS)
    target_compile_options(${target} PRIVATE
      -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=address,undefined)
  endif()
  if(BPA_FUZZ)  # what libFuzzer and llvm-cov ask of the compiler
    target_compile_options(${target} PRIVATE
      -fsanitize=fuzzer-no-link,float-cast-overflow -fprofile-instr-generate -fcoverage-mapping)
    target_link_options(${target} PUBLIC -fprofile-instr-generate)
  endif()
  if(BPA_SANITIZE_THREAD)
    target_compile_options(${target} PRIVATE -fsanitize=thread)
    target_link_options(${target} PUBLIC -fsanitize=thread)
  endif()
endfunction()
