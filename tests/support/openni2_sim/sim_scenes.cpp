// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/support/openni2_sim/sim_scenes.hpp"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <yaml-cpp/yaml.h>

#include "core/io/bop_dataset.hpp"
#include "core/io/camera_file.hpp"
#include "core/io/image_file.hpp"

namespace bpa::sim_driver {

namespace fs = std::filesystem;

SimConfig::SimConfig() {
  const char* named = std::getenv("BPA_SIM");
  if (named == nullptr) return;
  if (fs::is_directory(named)) {
    scenes = named;
  } else {
    file_ = named;
    refresh();
  }
}

void SimConfig::refresh() {
  std::ifstream file(file_);
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (text == text_ || text.empty()) return;
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap()) return;
    if (text_.empty()) {
      split = root["split"].as<std::string>(split);
      fine_depth = root["fine_depth"].as<bool>(fine_depth);
      const fs::path folder = fs::path(file_).parent_path() / root["scenes"].as<std::string>("");
      scenes = folder.lexically_normal().string();
    }
    deliver = root["deliver"].as<bool>(true);
    deliver_color = root["deliver_color"].as<bool>(true);
    wedged = root["wedged"].as<bool>(false);
    color_sensor = root["color_sensor"].as<bool>(true);
    const auto registration = root["registration"].as<std::string>("device");
    can_register = registration != "none";
    registers = can_register && registration != "pretended";
    plugged = root["plugged"].as<bool>(true);
    text_ = std::move(text);
  } catch (const YAML::Exception&) {
    return;
  }
}

void SimConfig::pass() const {
  while (wedged) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

namespace {

constexpr std::size_t kMaxFrames = 60;
constexpr double kUnit = 1e-4;  // metres of one unit of depth

std::uint16_t to_units(double metres) {
  const double units = std::round(metres / kUnit);
  return units > 0 && units <= 65535 ? static_cast<std::uint16_t>(units) : std::uint16_t{0};
}

/// The depth camera's view of what the colour camera sees; a nearer surface hides a farther one.
std::vector<std::uint16_t> moved(const std::vector<std::uint16_t>& registered,
                                 const Camera& camera) {
  std::vector<std::uint16_t> depth(registered.size(), 0);
  const auto width = static_cast<std::size_t>(camera.width);
  for (std::size_t i = 0; i < registered.size(); ++i) {
    const std::uint16_t z = registered[i];
    if (z == 0) continue;
    const std::size_t row = i / width * width;
    const double shifted = static_cast<double>(i - row) + camera.fx * kBaseline / (z * kUnit);
    for (const double x : {std::floor(shifted), std::ceil(shifted)}) {
      if (x >= camera.width) continue;
      std::uint16_t& place = depth[row + static_cast<std::size_t>(x)];
      if (place == 0 || z < place) place = z;
    }
  }
  return depth;
}

Result<SimFrame> load(const io::BopFrame& entry, const Camera& depth_camera) {
  const auto frame = io::load_bop_frame(entry);
  if (!frame.ok()) return frame.status();
  SimFrame out;
  out.rgb = frame->color;
  if (out.rgb.empty()) out.rgb.assign(3 * frame->depth.size(), 128);
  for (const float z : frame->depth) out.registered.push_back(to_units(z));
  fs::path own = fs::path(entry.depth_path);
  own = own.parent_path().parent_path() / "depth_ir" / own.filename();
  if (!fs::is_regular_file(own)) {
    out.unregistered = moved(out.registered, frame->camera);
    return out;
  }
  const auto image = io::read_gray_png(own.string());
  if (!image.ok()) return image.status();
  if (image->width != depth_camera.width || image->height != depth_camera.height) {
    return invalid_argument(own.string() + " has not the size of camera_ir.json");
  }
  for (const std::uint16_t value : image->pixels) {
    out.unregistered.push_back(to_units(value * entry.depth_scale_mm * 1e-3));
  }
  return out;
}

}  // namespace

Result<SimFrames> load_sim_frames(const std::string& dataset, const std::string& split) {
  const auto entries = io::read_bop_frames(dataset, split);
  if (!entries.ok()) return entries.status();
  if (entries->empty()) return Status(StatusCode::not_found, dataset + " holds no frames");
  SimFrames all;
  all.color = all.depth = entries->front().camera;
  const std::string own_camera = (fs::path(dataset) / "camera_ir.json").string();
  if (fs::is_regular_file(own_camera)) {
    const auto file = io::read_camera(own_camera);
    if (!file.ok()) return file.status();
    all.depth = file->camera;
  }
  for (const io::BopFrame& entry : *entries) {
    if (all.frames.size() == kMaxFrames) break;
    if (entry.camera.width != all.color.width || entry.camera.height != all.color.height ||
        entry.camera.fx != all.color.fx) {
      return invalid_argument(dataset + " has frames of different cameras");
    }
    auto frame = load(entry, all.depth);
    if (!frame.ok()) return frame.status();
    all.frames.push_back(std::move(frame).value());
  }
  return all;
}

}  // namespace bpa::sim_driver
