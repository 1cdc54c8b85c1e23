// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/camera_text.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "core/base/concat.hpp"
#include "core/io/yaml_text.hpp"

namespace bpa::io {
namespace {

Json json_of(const YAML::Node& yaml) {
  Json json;
  if (yaml.IsMap()) {
    json = Json::object();
    for (const auto& entry : yaml) json[entry.first.as<std::string>()] = json_of(entry.second);
  } else if (yaml.IsSequence()) {
    for (const auto& value : yaml) json.push_back(json_of(value));
  } else if (double number = 0; yaml.IsScalar() && YAML::convert<double>::decode(yaml, number)) {
    json = number;
  } else if (yaml.IsScalar()) {
    json = yaml.Scalar();
  }
  return json;
}

/// OpenCV's FileStorage as XML: elements that hold text or elements.
Json json_of_xml(const std::string& text) {
  constexpr std::size_t kDeepest = 16;
  std::vector<std::pair<std::string, Json>> open{{"", Json::object()}};
  for (std::size_t at = text.find('<'); at != text.npos;) {
    const std::size_t end = std::min(text.find('>', at), text.size() - 1);
    const std::size_t next = text.find('<', end + 1);
    const std::string tag = text.substr(at + 1, end - at - 1);
    if (tag.starts_with('/') && open.size() > 1) {
      auto [name, value] = std::move(open.back());
      open.pop_back();
      if (!open.back().second.is_object()) open.back().second = Json::object();
      open.back().second[name] = std::move(value);
    } else if (tag.find_first_of("/?!") > 0 && !tag.ends_with('/') && open.size() < kDeepest) {
      open.emplace_back(tag.substr(0, tag.find_first_of(" \t\r\n")),
                        text.substr(end + 1, next == text.npos ? next : next - end - 1));
    }
    at = next;
  }
  return open.front().second;
}

/// Whether a line of a text is a [section], or a key with an equals sign.
bool is_ini(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t equals = line.find_first_of("=:{#");
    if (equals != line.npos && line[equals] == '=') return true;
    if (line.starts_with('[') && std::isalpha(static_cast<unsigned char>(line[1])) != 0)
      return true;
  }
  return false;
}

/// Lines of "key = value"; and as ROS calibrators write it, a key alone with lines of numbers
/// below it. Each section holds its own.
Json json_of_ini(const std::string& text) {
  const auto trimmed = [](const std::string& all) {
    const std::size_t first = all.find_first_not_of(" \t\r\"'");
    const std::size_t last = all.find_last_not_of(" \t\r\"'");
    return first == all.npos ? std::string() : all.substr(first, last + 1 - first);
  };
  std::string section, key;
  std::map<std::string, std::map<std::string, std::string>> sections;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    line = trimmed(line.substr(0, line.find_first_of("#;")));
    const std::size_t equals = line.find('=');
    if (line.starts_with('[') && line.ends_with(']')) {
      section = line.substr(1, line.size() - 2);
    } else if (equals != line.npos) {
      sections[section][trimmed(line.substr(0, equals))] = trimmed(line.substr(equals + 1));
    } else if (bare_numbers(line)) {
      sections[section][key] += line + ' ';
    } else if (!line.empty()) {
      key = line;
    }
  }
  Json json = sections;
  for (const char* shared : {"image", ""}) json.update(json.value(shared, Json::object()));
  return json;
}

}  // namespace

std::optional<std::vector<double>> bare_numbers(std::string text) {
  for (std::size_t at = 0; (at = text.find('#', at)) != text.npos;) {
    text.erase(at, text.find('\n', at) - at);
  }
  for (char& c : text) {
    if (std::string_view("[](),;").find(c) != std::string_view::npos) c = ' ';
  }
  std::istringstream words(text);
  std::vector<double> numbers;
  for (double number = 0; words >> number;) numbers.push_back(number);
  if (numbers.empty() || !words.eof()) return std::nullopt;
  return numbers;
}

Result<Json> json_of_text(const std::string& path, std::string text) {
  if (const std::string content = content_of(text); !content.empty()) {
    return corrupt(path, " is no camera file, but ", content);
  }
  if (const auto numbers = bare_numbers(text)) {
    // Nine numbers are a matrix, or fx fy cx cy and the distortion of plumb_bob, as of TUM.
    const std::vector<double>& n = *numbers;
    if (n.size() != 9 || n[1] == 0 || n[3] == 0) return Json{{"k", n}};
    return Json{{"k", std::vector(n.begin(), n.begin() + 4)},
                {"d", std::vector(n.begin() + 4, n.end())}};
  }
  if (text.find_first_not_of(" \t\r\n") == text.find('{')) return parse_json(path, text);
  if (text.find("<opencv_storage>") != text.npos) return json_of_xml(text);
  if (is_ini(text)) return json_of_ini(text);
  // OpenCV's first line, which is no YAML.
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  return json_of(parse_yaml(text));
}

}  // namespace bpa::io
