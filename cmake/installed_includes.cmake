# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Rewrites the includes of the installed headers below BPA_HEADERS: "core/a.hpp" becomes
# <bpa/core/a.hpp>, "idl/wire/a.hpp" becomes <bpa/wire/a.hpp>.
file(GLOB_RECURSE headers ${BPA_HEADERS}/*.hpp)
foreach(header IN LISTS headers)
  file(READ ${header} content)
  string(REGEX REPLACE "#include \"core/([^\"]+)\"" "#include <bpa/core/\\1>" rewritten "${content}")
  string(REGEX REPLACE "#include \"idl/wire/([^\"]+)\"" "#include <bpa/wire/\\1>"
         rewritten "${rewritten}")
  if(NOT rewritten STREQUAL content)
    file(WRITE ${header} "${rewritten}")
  endif()
endforeach()
