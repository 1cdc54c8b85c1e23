# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Run with -D BPA_BINARY_DIR=... -D GENERATOR=... -D CONFIG=...: installs the SDK and builds its examples.
set(folder ${BPA_BINARY_DIR}/tests/examples)
file(REMOVE_RECURSE ${folder})
foreach(command IN ITEMS
    "--install;${BPA_BINARY_DIR};--component;sdk;--prefix;${folder}/prefix"
    "-S;${folder}/prefix/share/bpa/examples;-B;${folder}/build;-G;${GENERATOR};-DCMAKE_BUILD_TYPE=${CONFIG};-DCMAKE_PREFIX_PATH=${folder}/prefix"
    "--build;${folder}/build")
  execute_process(COMMAND ${CMAKE_COMMAND} ${command} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
