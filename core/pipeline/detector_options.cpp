// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector_options.hpp"

#include "core/pipeline/yaml_options.hpp"

namespace bpa {

Result<DetectorOptions> load_detector_options(const std::string& path) {
  YAML::Node document;
  try {
    document = YAML::LoadFile(path);
  } catch (const YAML::BadFile&) {
    return Status(StatusCode::not_found, path + " cannot be read");
  } catch (const YAML::ParserException& error) {
    return invalid_argument(path + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  }
  DetectorOptions options;
  if (Status status = read_yaml_options(document, path, options); !status.ok()) return status;
  return options;
}

}  // namespace bpa
