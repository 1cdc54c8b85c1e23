// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openni2/Driver/OniDriverAPI.h>

#include "camera/openni2_sim/sim_scenes.hpp"

namespace bpa::sim_driver {

/// The opened device: a depth and a colour stream, and the thread that shows them the frames at
/// 30 Hz. The caller deletes it; `config` outlives it.
oni::driver::DeviceBase* new_sim_device(SimFrames frames, const SimConfig& config);

}  // namespace bpa::sim_driver
