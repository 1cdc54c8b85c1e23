// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <bpa/client.hpp>

#include "core/cloud/frame.hpp"
#include "core/doctor/finding.hpp"

// The parts of bpa doctor that look at what runs.

namespace bpa::cli {

/// What is wrong with a server, from two of its statuses some seconds apart.
doctor::Findings check_server(const ServerStatus& before, const ServerStatus& after);

struct RunningFindings {
  doctor::Findings server;
  doctor::Findings machine;
};

/// The same of the server that answers within `options.timeout`, or that there is none, and what is
/// wrong with this machine. Takes up to four times `options.timeout`.
RunningFindings check_running_server(ClientOptions options);

/// A frame of a camera that bpa-server --capture can open, once its exposure has settled. Fails
/// when none comes within `timeout_s`.
Result<Frame> frame_of_sensor(const std::string& source, double timeout_s);

}  // namespace bpa::cli
