// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <string_view>

#include "core/io/file_bytes.hpp"
#include "core/io/results.hpp"

namespace bpa::io {
namespace {

constexpr double kMillimetres = 1000;
constexpr const char* kHeader = "scene_id,im_id,obj_id,score,R,t,time";

void write_number(std::ostream& out, double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;  // shortest exact form
  out.write(text, end - text);
}

void write_row(std::ostream& out, const FrameResult& frame, const Placement& placement) {
  out << frame.scene_id << ',' << frame.im_id << ',' << placement.model_number << ',';
  write_number(out, placement.probability);
  const Eigen::Matrix3d r = placement.camera_from_object.matrix();
  for (int i = 0; i < 9; ++i) {
    out << (i == 0 ? ',' : ' ');
    write_number(out, r(i / 3, i % 3));
  }
  for (int i = 0; i < 3; ++i) {
    out << (i == 0 ? ',' : ' ');
    write_number(out, kMillimetres * placement.camera_from_object.translation[i]);
  }
  out << ',';
  write_number(out, frame.seconds);
  out << '\n';
}

/// Splits into exactly N numbers; false otherwise.
template <std::size_t N>
bool parse_numbers(std::string_view text, double (&values)[N]) {
  const char* at = text.data();
  const char* const end = at + text.size();
  for (double& value : values) {
    while (at != end && *at == ' ') ++at;
    const auto result = std::from_chars(at, end, value);
    if (result.ec != std::errc() || !std::isfinite(value)) return false;
    at = result.ptr;
  }
  while (at != end && (*at == ' ' || *at == '\r')) ++at;
  return at == end;
}

struct Row {
  double scene[1], image[1], object[1], score[1], rotation[9], translation[3], time[1];
};

/// Empty when the line is right; else the name of the wrong column.
std::string parse_row(const std::string& line, Row& row) {
  std::vector<std::string_view> cells;
  const std::string_view text(line);
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t comma = std::min(text.find(',', at), text.size());
    cells.push_back(text.substr(at, comma - at));
    at = comma + 1;
  }
  if (cells.size() != 7) return "count (7 columns are needed)";
  if (!parse_numbers(cells[0], row.scene)) return "scene_id";
  if (!parse_numbers(cells[1], row.image)) return "im_id";
  if (!parse_numbers(cells[2], row.object)) return "obj_id";
  if (!parse_numbers(cells[3], row.score)) return "score";
  if (!parse_numbers(cells[4], row.rotation)) return "R (9 numbers)";
  if (!parse_numbers(cells[5], row.translation)) return "t (3 numbers)";
  if (!parse_numbers(cells[6], row.time)) return "time";
  return {};
}

Placement placement_of(const Row& row) {
  Placement placement;
  placement.model_number = static_cast<int>(row.object[0]);
  placement.score = row.score[0];
  placement.probability = row.score[0];
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  for (int i = 0; i < 9; ++i) matrix(i / 3, i % 3) = row.rotation[i];
  for (int i = 0; i < 3; ++i) matrix(i, 3) = row.translation[i] / kMillimetres;
  placement.camera_from_object = Pose::from_matrix(matrix);
  return placement;
}

}  // namespace

Status write_results_csv(const std::string& path, const std::vector<FrameResult>& results) {
  std::ostringstream out;
  out << kHeader << '\n';
  for (const FrameResult& frame : results) {
    if (frame.interpretations.empty()) continue;
    for (const Placement& placement : frame.interpretations.front().placements) {
      write_row(out, frame, placement);
    }
  }
  return write_file(path, out.str());
}

Result<std::vector<FrameResult>> read_results_csv(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  std::map<std::pair<int, int>, FrameResult> frames;
  std::istringstream in(*bytes);
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || line == "\r" || (number == 1 && line.rfind("scene_id", 0) == 0)) continue;
    Row row;
    if (const std::string wrong = parse_row(line, row); !wrong.empty()) {
      return Status(StatusCode::corrupt,
                    path + " line " + std::to_string(number) + ": wrong column " + wrong);
    }
    const std::pair key(static_cast<int>(row.scene[0]), static_cast<int>(row.image[0]));
    FrameResult& frame = frames[key];
    frame.scene_id = key.first;
    frame.im_id = key.second;
    frame.seconds = row.time[0];
    if (frame.interpretations.empty()) {
      frame.interpretations.emplace_back();
      frame.interpretations.front().probability = 1;
    }
    frame.interpretations.front().placements.push_back(placement_of(row));
  }
  std::vector<FrameResult> results;
  for (auto& [key, frame] : frames) results.push_back(std::move(frame));
  return results;
}

}  // namespace bpa::io
