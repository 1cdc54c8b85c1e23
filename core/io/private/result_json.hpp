// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/private/json_file.hpp"
#include "core/result/placement.hpp"

// What files of placements and files of tracks share.

namespace bpa {

static void fields(auto& visit, io::Is<PoseAlternative> auto& alternative) {
  visit("pose", alternative.frame_from_object);
  visit("weight", alternative.weight);
}

static void fields(auto& visit, io::Is<OrientationUncertainty> auto& orientation) {
  visit("axes", orientation.axes);
  visit("concentrations", orientation.concentrations);
}

}  // namespace bpa

namespace bpa::io {

/// What a file of frames says that it is.
struct FramesFormat {
  const char* name;     ///< The value of its key "format".
  const char* article;  ///< What an error calls it: "a result file".
  int version;
};

template <class FrameType>
std::string json_line(const FrameType& frame) {
  return written(frame);
}

template <class FrameType>
std::string frames_json(const FramesFormat& format, const std::vector<FrameType>& frames) {
  const Json json = {{"format", format.name}, {"version", format.version}, {"frames", frames}};
  return written(json, 1) + "\n";
}

template <class FrameType>
Status write_frames_json(const std::string& path, const FramesFormat& format,
                         const std::vector<FrameType>& frames) {
  return with_json(path, [&]() { return write_file(path, frames_json(format, frames)); });
}

template <class FrameType>
Result<std::vector<FrameType>> read_frames_json(const std::string& path,
                                                const FramesFormat& format) {
  return read_json(path, [&](const Json& json) -> Result<std::vector<FrameType>> {
    if (json.value("format", "") != format.name ||
        whole_number<int>(json.at("version")) != format.version) {
      return corrupt(path, " is not ", format.article, " of version ", format.version);
    }
    return json.at("frames").get<std::vector<FrameType>>();
  });
}

}  // namespace bpa::io
