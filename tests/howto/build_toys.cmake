# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Brings the copy of the tree up to date, builds the toys in it, and runs their test.
foreach(command "${toys}" "${CMAKE_COMMAND};--build;${build};--target;howto_toys"
        "${build}/tests/howto_toys")
  execute_process(COMMAND ${command} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
