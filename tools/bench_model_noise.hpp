// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/modeling/posed_view.hpp"

namespace bpa::cli {

/// Learns a model's noise from every second view and prints what it predicts beside the errors of
/// the other views and beside the simulated sensor's law. Six plots go to the folder `plots` unless
/// that is empty.
void measure_noise(const ModelSource& model, const std::vector<PosedView>& views,
                   const std::string& name, const std::string& plots, int num_threads);

}  // namespace bpa::cli
