// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "core/base/status.hpp"
#include "core/detect/pose_prior.hpp"
#include "idl/wire/msg/bpa_msgs.hpp"

namespace bpa::server {

/// The priors of a message as the detector takes them, which also checks their numbers: camera
/// frame, as the message's. Fails with invalid_argument where pose.orientation is not the most
/// probable one of the distribution that comes with it.
Result<std::vector<PosePrior>> priors_from_messages(
    const std::vector<wire::bpa_msgs::PosePrior>& messages);

}  // namespace bpa::server
