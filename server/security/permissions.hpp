// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/options.hpp"

namespace bpa::server {

/// Who may do what in DDS, by topics as DDS names them; all else is denied.
struct Permissions {
  std::string enclave;                 ///< "/robot"
  std::vector<std::string> publish;    ///< '*' stands for any characters.
  std::vector<std::string> subscribe;  ///< Likewise.
};

/// What --make-keystore gives: /bpa_server what this server needs, /robot its inputs, outputs and
/// services, /viewer its inputs and outputs to read alone. Names are those of the settings;
/// services are those below the server's namespace. Throws a Failure when a name is not legal.
std::vector<Permissions> default_permissions(const ServerOptions& options);

}  // namespace bpa::server
