# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
# Debian packages: `cpack --config build/release/CPackConfig.cmake` makes bpa-server (the daemon, its
# systemd unit, its settings, RViz's, the messages), bpa-tools (bpa, bpa-client), libbpa-client-dev
# (the SDK) and python3-bpa. C++ detection inside one's own process (bpa::core) is for `cmake --install`.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "The bpa authors")
set(CPACK_PACKAGE_CONTACT "The bpa authors <bpa@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "6-DoF detection of known objects in RGB-D frames")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_COMPONENTS_ALL server tools sdk)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME bpa-server)
set(CPACK_COMPONENT_SERVER_DESCRIPTION
    "Detects known objects in the RGB-D frames of a DDS domain; a ROS 2 peer.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME bpa-tools)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
    "Models, detection, simulation and evaluation offline (bpa); a client (bpa-client).")
set(CPACK_DEBIAN_SDK_PACKAGE_NAME libbpa-client-dev)
set(CPACK_DEBIAN_SDK_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_SDK_DESCRIPTION "C++ SDK for programs that talk to bpa-server.")
string(REGEX MATCH "^[a-z]+" fast_dds "${BPA_FASTDDS_PACKAGE}")
set(CPACK_DEBIAN_SDK_PACKAGE_DEPENDS "lib${fast_dds}-dev")

if(TARGET bpa_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-bpa)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
      "Detection of known objects in numpy arrays, and a client of bpa-server.")
  # An extension is of one Python.
  get_property(python DIRECTORY python PROPERTY BPA_PYTHON_VERSION)
  math(EXPR next "${python} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3-numpy, python3 (>= 3.${python}), python3 (<< 3.${next})")
endif()

# Where Debian's systemd looks, whatever the prefix of the rest.
install(FILES config/bpa-server.service DESTINATION lib/systemd/system COMPONENT server)

include(CPack)
