# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Installs libraries, headers, programs, settings and the package config.
#
# Three libraries for users: bpa::core (all rooms), bpa::wire and bpa::client. Each has its own export
# set, so that whoever wants only the client needs only what the client needs. bpa::core_base, which
# all three share, has one too.
include(CMakePackageConfigHelpers)

set(BPA_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/bpa)

# The package (BpaPackages.cmake) that a library for users belongs to: all but the core is the SDK's.
function(bpa_package_of component package)
  if(component STREQUAL core)
    set(${package} core PARENT_SCOPE)
  else()
    set(${package} sdk PARENT_SCOPE)
  endif()
endfunction()

# bpa_install_libraries(COMPONENT TARGETS target...): libraries with their export set.
function(bpa_install_libraries component)
  cmake_parse_arguments(INSTALL "" "" "TARGETS" ${ARGN})
  if(INSTALL_TARGETS)
    bpa_package_of(${component} package)
    install(TARGETS ${INSTALL_TARGETS} EXPORT bpa-${component}
            ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${package}
            LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${package})
    install(EXPORT bpa-${component} NAMESPACE bpa:: DESTINATION ${BPA_CMAKE_DIR}
            COMPONENT ${package})
  endif()
endfunction()

get_property(bpa_rooms GLOBAL PROPERTY BPA_CORE_ROOMS)
add_library(bpa_core INTERFACE)
add_library(bpa::core ALIAS bpa_core)
set_target_properties(bpa_core PROPERTIES EXPORT_NAME core)
target_link_libraries(bpa_core INTERFACE ${bpa_rooms})

list(REMOVE_ITEM bpa_rooms bpa_core_base)
bpa_install_libraries(base TARGETS bpa_core_base)
bpa_install_libraries(core TARGETS bpa_core ${bpa_rooms})
foreach(component wire client)
  if(TARGET bpa_${component})
    set_target_properties(bpa_${component} PROPERTIES EXPORT_NAME ${component})
    bpa_install_libraries(${component} TARGETS bpa_${component})
  endif()
endforeach()

set(bpa_header_folder ${CMAKE_INSTALL_INCLUDEDIR}/bpa)
# A header in a folder "private" is its room's own (tests/style/arrows.py) and is not installed.
set(bpa_public_headers FILES_MATCHING PATTERN "*.hpp" PATTERN "private" EXCLUDE)
install(DIRECTORY core DESTINATION ${bpa_header_folder} COMPONENT core
        ${bpa_public_headers} PATTERN "base" EXCLUDE)
install(DIRECTORY core/base DESTINATION ${bpa_header_folder}/core COMPONENT sdk ${bpa_public_headers})
install(DIRECTORY idl/wire ${CMAKE_BINARY_DIR}/generated/idl/wire DESTINATION ${bpa_header_folder}
        COMPONENT sdk ${bpa_public_headers} PATTERN "fastdds" EXCLUDE)
install(DIRECTORY client/include/bpa DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT sdk
        FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY client/examples DESTINATION ${CMAKE_INSTALL_DATADIR}/bpa COMPONENT sdk)
# In the tree, includes are paths of the tree; installed headers lie below include/bpa.
foreach(component core sdk)
  install(CODE "set(BPA_HEADERS \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${bpa_header_folder}\")"
          COMPONENT ${component})
  install(SCRIPT cmake/installed_includes.cmake COMPONENT ${component})
endforeach()
# The messages, for a ROS 2 workspace, and the settings: nothing reads these by itself.
install(DIRECTORY idl/bpa_msgs DESTINATION ${CMAKE_INSTALL_DATADIR}/bpa COMPONENT server)
install(DIRECTORY config DESTINATION ${CMAKE_INSTALL_DATADIR}/bpa COMPONENT server
        PATTERN "apt-packages*.txt" EXCLUDE PATTERN "readme" EXCLUDE
        PATTERN "dds_profiles.xml" EXCLUDE)
install(FILES ${CMAKE_BINARY_DIR}/config/dds_profiles.xml
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bpa/config COMPONENT server)

foreach(program bpa bpa-server bpa-client)
  if(TARGET ${program})
    set(package tools)
    if(program STREQUAL bpa-server)
      set(package server)
    endif()
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${package})
  endif()
endforeach()

configure_package_config_file(cmake/bpa-config.cmake.in ${CMAKE_BINARY_DIR}/bpa-config.cmake
                              INSTALL_DESTINATION ${BPA_CMAKE_DIR})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/bpa-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/bpa-config.cmake ${CMAKE_BINARY_DIR}/bpa-config-version.cmake
        DESTINATION ${BPA_CMAKE_DIR} COMPONENT sdk)

include(BpaPackages)
