// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/openni2_sim/sim_config.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <yaml-cpp/yaml.h>

namespace bpa::sim_driver {
namespace {

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

Registration registration_of(const std::string& word) {
  if (word == "pretended") return Registration::pretended;
  if (word == "none") return Registration::none;
  return Registration::device;
}

}  // namespace

SimConfig::SimConfig() {
  const char* named = std::getenv("BPA_SIM");
  if (named == nullptr || *named == '\0') return;
  if (std::filesystem::is_directory(named)) {
    scenes = named;
    return;
  }
  file_ = named;
  try {
    const YAML::Node root = YAML::LoadFile(file_);
    scenes = (std::filesystem::path(file_).parent_path() / root["scenes"].as<std::string>(""))
                 .lexically_normal()
                 .string();
    split = root["split"].as<std::string>(split);
    fine_depth = root["fine_depth"].as<bool>(fine_depth);
  } catch (const YAML::Exception&) {
    return;  // no such file, or no settings: no device
  }
  refresh();
}

void SimConfig::refresh() {
  if (file_.empty()) return;
  std::string text = text_of(file_);
  if (text == text_ || text.empty()) return;
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap()) return;
    deliver = root["deliver"].as<bool>(true);
    deliver_color = root["deliver_color"].as<bool>(true);
    wedged = root["wedged"].as<bool>(false);
    color_sensor = root["color_sensor"].as<bool>(true);
    registration = registration_of(root["registration"].as<std::string>("device"));
    plugged = root["plugged"].as<bool>(true);
    text_ = std::move(text);
  } catch (const YAML::Exception&) {
    return;
  }
}

void SimConfig::pass() const {
  while (wedged) std::this_thread::sleep_for(std::chrono::milliseconds(10));
}

}  // namespace bpa::sim_driver
