// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/recorder.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include <nlohmann/json.hpp>

#include "client/cli/output.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/image_file.hpp"

namespace bpa::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kScene = "test/000001";
constexpr double kFloatUnit_mm = 0.1;

std::vector<std::uint16_t> depth_of(const FrameView& frame) {
  const auto count = static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
  if (frame.depth_mm != nullptr) return {frame.depth_mm, frame.depth_mm + count};
  std::vector<std::uint16_t> depth;
  depth.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double units = std::round(static_cast<double>(frame.depth_m[i]) * 1000 / kFloatUnit_mm);
    depth.push_back(units > 0 && units <= 65535 ? static_cast<std::uint16_t>(units)
                                                : std::uint16_t{0});
  }
  return depth;
}

Status write_json(const fs::path& path, const Json& json) {
  return io::write_file(path.string(), json.dump(1) + "\n");
}

}  // namespace

Status Recorder::start(Client& client) {
  std::error_code error;
  if (fs::exists(folder_, error)) return invalid_argument(folder_ + ": is there already");
  Status status = io::make_folder((fs::path(folder_) / kScene / "depth").string());
  if (!status.ok()) return status;
  status = client.subscribe_frames([this](const FrameView& frame) { add(frame); });
  if (!status.ok()) return status;
  return client.subscribe([this](const DetectionSet& set) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!finished_) results_.push_back(set);
  });
}

void Recorder::add(const FrameView& frame) {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard<std::mutex> lock(mutex_);
  if (finished_ || !trouble_.ok()) return;
  if (frames_.empty()) first_ = now;
  trouble_ = write(frame, static_cast<int>(frames_.size()));
  if (!trouble_.ok()) return;
  const std::chrono::duration<double> after = now - first_;
  frames_.push_back({after.count(), frame.stamp_ns, frame.frame_id});
}

Status Recorder::write(const FrameView& frame, int number) {
  const std::string name = io::bop_number(number) + ".png";
  const fs::path scene = fs::path(folder_) / kScene;
  if (frame.rgb != nullptr) {
    const auto bytes = std::size_t{3} * static_cast<std::size_t>(frame.width) *
                       static_cast<std::size_t>(frame.height);
    Status status =
        io::write_color_png((scene / "rgb" / name).string(),
                            {frame.width, frame.height, {frame.rgb, frame.rgb + bytes}});
    if (!status.ok()) return status;
  }
  const Json camera = {{"cam_K", {frame.fx, 0, frame.cx, 0, frame.fy, frame.cy, 0, 0, 1}},
                       {"depth_scale", frame.depth_mm != nullptr ? 1.0 : kFloatUnit_mm}};
  cameras_.push_back(camera.dump());
  return io::write_gray_png((scene / "depth" / name).string(),
                            {frame.width, frame.height, depth_of(frame)});
}

Status Recorder::finish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  finished_ = true;
  Json cameras = Json::object(), times = Json::array();
  for (std::size_t i = 0; i < frames_.size(); ++i) {
    cameras[std::to_string(i)] = Json::parse(cameras_[i]);
    times.push_back({{"after_s", frames_[i].after_s},
                     {"stamp_ns", frames_[i].stamp_ns},
                     {"frame_id", frames_[i].frame_id}});
  }
  const fs::path folder(folder_);
  Status status = write_json(folder / kScene / "scene_camera.json", cameras);
  if (status.ok()) {
    status = write_json(folder / "recording.json",
                        {{"format", "bpa recording"}, {"version", 1}, {"frames", times}});
  }
  if (status.ok()) status = write_results((folder / "results.json").string(), results_);
  std::printf("%zu frames and %zu results in %s\n", frames_.size(), results_.size(),
              folder_.c_str());
  return trouble_.ok() ? status : trouble_;
}

Result<std::vector<RecordedFrame>> read_recording(const std::string& folder) {
  const std::string path = (fs::path(folder) / "recording.json").string();
  const auto bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  try {
    const Json json = Json::parse(*bytes);
    std::vector<RecordedFrame> frames;
    for (const Json& frame : json.at("frames")) {
      frames.push_back({frame.at("after_s").get<double>(), frame.at("stamp_ns").get<std::int64_t>(),
                        frame.at("frame_id").get<std::string>()});
    }
    return frames;
  } catch (const std::exception& error) {
    return Status(StatusCode::corrupt, path + ": " + error.what());
  }
}

}  // namespace bpa::cli
