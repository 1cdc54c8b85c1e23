// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector_options.hpp"

#include "core/io/options_yaml.hpp"

namespace bpa {

Result<DetectorOptions> load_detector_options(const std::string& path) {
  DetectorOptions options;
  Status status = io::read_options(path, {options_of(options), "", {}});
  if (!status.ok()) return status;
  return options;
}

}  // namespace bpa
