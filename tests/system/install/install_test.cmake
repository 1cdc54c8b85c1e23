# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Run with -D COMPONENT=core|wire|client -D BPA_BINARY_DIR=... -D GENERATOR=... -D CONFIG=...
set(folder ${BPA_BINARY_DIR}/tests/install_${COMPONENT})
file(REMOVE_RECURSE ${folder})

# run(ARGUMENT...): one command, whose output is shown if it fails.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

run(${CMAKE_COMMAND} --install ${BPA_BINARY_DIR} --prefix ${folder}/prefix)
file(GLOB_RECURSE headers ${folder}/prefix/include/*.hpp)
foreach(header IN LISTS headers)
  file(STRINGS ${header} private REGEX "#include .*/private/")
  if(header MATCHES "/private/" OR private)
    message(FATAL_ERROR "${header}: a room's private header is installed or needed")
  endif()
endforeach()
set(LANGUAGES CXX)
if(COMPONENT STREQUAL core)
  set(LANGUAGES "C CXX")  # PCL's VTK asks for MPI_C
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/consumer.cmake.in ${folder}/source/CMakeLists.txt @ONLY)
run(${CMAKE_COMMAND} -S ${folder}/source -B ${folder}/build -G ${GENERATOR}
    -D CMAKE_BUILD_TYPE=${CONFIG} -D CMAKE_PREFIX_PATH=${folder}/prefix)
run(${CMAKE_COMMAND} --build ${folder}/build)
run(${folder}/build/consumer)
message(STATUS "${output}")

# The SDK must come without what the detector needs.
if(NOT COMPONENT STREQUAL core)
  file(STRINGS ${folder}/build/CMakeCache.txt heavy REGEX "^(PCL|OpenCV|Eigen3)_DIR")
  if(heavy)
    message(FATAL_ERROR "find_package(bpa COMPONENTS ${COMPONENT}) looked for ${heavy}")
  endif()
endif()
file(REMOVE_RECURSE ${folder})
