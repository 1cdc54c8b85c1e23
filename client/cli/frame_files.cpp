// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/frame_files.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/cli/png_file.hpp"

namespace bpa::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

std::string padded(int number) {
  char text[16];
  std::snprintf(text, sizeof text, "%06d", number);
  return text;
}

Result<Json> read_json(const std::string& path) {
  std::ifstream file(path);
  if (!file) return Status(StatusCode::not_found, path + ": there is no such file");
  Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded()) return Status(StatusCode::corrupt, path + ": not JSON");
  return json;
}

/// Runs something that reads JSON fields; what is missing or of another type is `corrupt`.
template <class Read>
auto with_fields(const std::string& path, Read read) -> decltype(read()) {
  try {
    return read();
  } catch (const std::exception& error) {
    return Status(StatusCode::corrupt, path + ": " + error.what());
  }
}

void read_intrinsics(const Json& camera, FrameEntry& entry) {
  if (camera.contains("cam_K")) {
    const auto k = camera.at("cam_K").get<std::vector<double>>();
    entry.fx = k.at(0);
    entry.cx = k.at(2);
    entry.fy = k.at(4);
    entry.cy = k.at(5);
  } else {
    entry.fx = camera.at("fx").get<double>();
    entry.fy = camera.at("fy").get<double>();
    entry.cx = camera.at("cx").get<double>();
    entry.cy = camera.at("cy").get<double>();
  }
  entry.depth_scale_mm = camera.value("depth_scale", 1.0);
}

Status list_scene(const fs::path& folder, int scene, std::vector<FrameEntry>& entries) {
  const std::string path = (folder / "scene_camera.json").string();
  const auto cameras = read_json(path);
  if (!cameras.ok()) return cameras.status();
  return with_fields(path, [&]() -> Status {
    for (const auto& [key, camera] : cameras->items()) {
      FrameEntry entry;
      entry.scene_id = scene;
      entry.im_id = std::stoi(key);
      read_intrinsics(camera, entry);
      const std::string image = padded(entry.im_id) + ".png";
      entry.depth_path = (folder / "depth" / image).string();
      const fs::path color = folder / "rgb" / image;
      if (fs::exists(color)) entry.color_path = color.string();
      entries.push_back(std::move(entry));
    }
    return {};
  });
}

Result<std::vector<FrameEntry>> list_bop(const FrameFiles& files) {
  const fs::path split = fs::path(files.bop) / files.split;
  std::error_code error;
  if (!fs::is_directory(split, error)) {
    return Status(StatusCode::not_found, split.string() + ": there is no such split");
  }
  std::vector<FrameEntry> entries;
  for (const auto& folder : fs::directory_iterator(split, error)) {
    const std::string name = folder.path().filename().string();
    if (name.size() != 6 || name.find_first_not_of("0123456789") != std::string::npos) continue;
    const int scene = std::stoi(name);
    const bool wanted = files.scenes.empty() || std::find(files.scenes.begin(), files.scenes.end(),
                                                          scene) != files.scenes.end();
    if (!wanted) continue;
    if (Status status = list_scene(folder.path(), scene, entries); !status.ok()) return status;
  }
  if (entries.empty()) {
    return Status(StatusCode::not_found, split.string() + ": holds no frames of these scenes");
  }
  std::sort(entries.begin(), entries.end(), [](const FrameEntry& a, const FrameEntry& b) {
    return std::tie(a.scene_id, a.im_id) < std::tie(b.scene_id, b.im_id);
  });
  return entries;
}

}  // namespace

std::string FrameEntry::name() const {
  return std::to_string(scene_id) + "/" + std::to_string(im_id);
}

Result<std::vector<FrameEntry>> list_frames(const FrameFiles& files) {
  if (!files.bop.empty()) return list_bop(files);
  FrameEntry entry;
  entry.depth_path = files.depth;
  entry.color_path = files.color;
  const auto camera = read_json(files.camera);
  if (!camera.ok()) return camera.status();
  const Status status = with_fields(files.camera, [&]() -> Status {
    read_intrinsics(*camera, entry);
    return {};
  });
  if (!status.ok()) return status;
  return std::vector<FrameEntry>{entry};
}

Result<LoadedFrame> load_frame(const FrameEntry& entry, std::int64_t stamp_ns) {
  LoadedFrame frame;
  const auto depth = read_depth_png(entry.depth_path);
  if (!depth.ok()) return depth.status();
  frame.depth_m.reserve(depth->pixels.size());
  for (const std::uint16_t pixel : depth->pixels) {
    frame.depth_m.push_back(static_cast<float>(pixel * entry.depth_scale_mm * 0.001));
  }
  if (!entry.color_path.empty()) {
    auto color = read_color_png(entry.color_path);
    if (!color.ok()) return color.status();
    if (color->width != depth->width || color->height != depth->height) {
      return invalid_argument(entry.color_path + ": is " + std::to_string(color->width) + "x" +
                              std::to_string(color->height) + "; it must be as large as " +
                              entry.depth_path);
    }
    frame.rgb = std::move(color->rgb);
  }
  frame.view.width = depth->width;
  frame.view.height = depth->height;
  frame.view.rgb = frame.rgb.empty() ? nullptr : frame.rgb.data();
  frame.view.depth_m = frame.depth_m.data();
  frame.view.fx = entry.fx;
  frame.view.fy = entry.fy;
  frame.view.cx = entry.cx;
  frame.view.cy = entry.cy;
  frame.view.stamp_ns = stamp_ns;
  frame.view.frame_id = entry.name();
  return frame;
}

}  // namespace bpa::cli
