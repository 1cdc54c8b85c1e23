# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0

# bpa_room(NAME SOURCES a.cpp ... [USES room ...] [PUBLIC_LIBS lib ...] [PRIVATE_LIBS lib ...])
#
# Declares the static library bpa_core_NAME (alias bpa::core_NAME) of one room of core/. USES names
# the rooms it may include; tests/style checks that the includes agree with ARCHITECTURE.md.
function(bpa_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;USES;PUBLIC_LIBS;PRIVATE_LIBS" ${ARGN})
  set(target bpa_core_${name})
  add_library(${target} STATIC ${ROOM_SOURCES})
  add_library(bpa::core_${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME core_${name})
  bpa_compile_options(${target})
  bpa_compile_together(${target})
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(room IN LISTS ROOM_USES)
    target_link_libraries(${target} PUBLIC bpa_core_${room})
  endforeach()
  target_link_libraries(${target} PUBLIC ${ROOM_PUBLIC_LIBS} PRIVATE ${ROOM_PRIVATE_LIBS})
  set_property(GLOBAL APPEND PROPERTY BPA_CORE_ROOMS ${target})
endfunction()
