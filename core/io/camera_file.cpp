// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// One reader of all forms. JSON, YAML and bare numbers become JSON; the keys that people write
// become ours; and these become a camera.
#include "core/io/camera_file.hpp"

#include <algorithm>
#include <cctype>
#include <optional>
#include <set>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "core/base/concat.hpp"
#include "core/geometry/lens.hpp"
#include "core/io/private/json_file.hpp"
#include "core/io/yaml_text.hpp"

namespace bpa::io {
namespace {

/// What keys mean here, and the keys, in lower case, letters and digits alone. Those without a
/// meaning say nothing of a pinhole. A matrix of "columns" may stand column by column.
constexpr std::pair<const char*, const char*> kCameraKeys[] = {
    {"fx", " fx "},
    {"fy", " fy "},
    {"cx", " cx ppx "},
    {"cy", " cy ppy "},
    {"rows", " k camk cameramatrix intrinsics intrinsic mtx "},
    {"columns", " intrinsicmatrix "},
    {"width", " width imagewidth "},
    {"height", " height imageheight "},
    {"size", " resolution imagesize "},
    {"depth_scale", " depthscale "},
    {"distortion", " d distcoeffs distortioncoeffs distortioncoefficients dist distortion coeffs "},
    {"model", " distortionmodel model "},
    {"projection", " p projectionmatrix "},
    {"binning", " binningx binningy "},
    {"",
     " header cameraname cameramodel name r rectificationmatrix roi classname versionmajor "
     "versionminor extrinsic camrw2c camtw2c stampns "}};

/// Null for a key that is not known.
const char* meaning_of(const std::string& key) {
  std::string plain = " ";
  for (const unsigned char c : key) {
    if (std::isalnum(c) != 0) plain.push_back(static_cast<char>(std::tolower(c)));
  }
  plain += ' ';
  for (const auto& [meaning, names] : kCameraKeys) {
    if (std::string_view(names).find(plain) != std::string_view::npos) return meaning;
  }
  return nullptr;
}

/// The cameras of a file: by our keys, with what stands around them.
struct FoundCameras {
  std::vector<std::pair<std::string, Json>> cameras;  ///< With the key that each stands under.
  std::set<std::string> unread, all;                  ///< Keys.
};

void look_for_cameras(const std::string& name, const Json& json, Json known, FoundCameras& found) {
  if (!json.is_object()) return;
  std::vector<std::pair<std::string, const Json*>> inner;
  for (const auto& [key, value] : json.items()) {
    const Json& data = value.is_object() && value.contains("data") ? value.at("data") : value;
    const char* meaning = meaning_of(key);
    found.all.insert(key);
    if (data.is_object() && (meaning == nullptr || *meaning != 0)) {
      inner.emplace_back(key, &data);
    } else if (meaning == nullptr) {
      found.unread.insert(key);
    } else if (*meaning != 0) {
      known[meaning] = data;
    }
  }
  const auto has = [&](const char* key) { return known.contains(key); };
  if (has("fx") || has("fy") || has("rows") || has("columns") || has("projection")) {
    found.cameras.emplace_back(name, std::move(known));
    for (const auto& [key, value] : inner) found.unread.insert(key);
    return;
  }
  for (const auto& [key, value] : inner) look_for_cameras(key, *value, known, found);
}

void append_numbers(const Json& json, std::vector<double>& numbers) {
  if (!json.is_array()) return numbers.push_back(json.get<double>());
  for (const Json& one : json) append_numbers(one, numbers);
}

std::vector<double> numbers_of(const Json& json) {
  std::vector<double> numbers;
  append_numbers(json, numbers);
  return numbers;
}

/// Sets fx, fy, cx and cy of `known` by its matrix, also where that is refused.
Status read_matrix(Json& known) {
  const bool columns = known.contains("columns");
  const std::vector<double> k = numbers_of(known.at(columns ? "columns" : "rows"));
  const auto set = [&](double fx, double fy, double cx, double cy) {
    known.update({{"fx", fx}, {"fy", fy}, {"cx", cx}, {"cy", cy}});
  };
  if (k.size() == 4) {
    set(k[0], k[1], k[2], k[3]);
    return {};
  }
  if (k.size() != 9 && k.size() != 12 && k.size() != 16) {
    return corrupt("it has ", k.size(), " numbers; it must be fx fy cx cy, or 3 x 3 row by row");
  }
  const std::size_t row = k.size() == 9 ? 3 : 4;
  const auto is_pinhole = [&](std::size_t down, std::size_t right) {
    set(k[0], k[row + 1], k[2 * right], k[row + 1 + right]);
    return k[down] == 0 && k[2 * down] == 0 && k[2 * down + right] == 0 && k[2 * row + 2] == 1;
  };
  if (is_pinhole(row, 1) || (columns && row == 3 && is_pinhole(1, row))) {
    constexpr double kLittleSkew = 0.001;  // of fx: at most half a pixel at the edge of an image
    const double skew = k[1] + (columns ? k[row] : 0);
    if (std::abs(skew) <= kLittleSkew * std::abs(k[0])) return {};
    return invalid_argument("its matrix has the skew ", skew, "; it must be 0");
  }
  const bool turned = row == 3 && is_pinhole(1, row);
  if (!turned) (void)is_pinhole(row, 1);
  return invalid_argument("the third row of its matrix is ", k[2 * row], ' ', k[2 * row + 1], ' ',
                          k[2 * row + 2], "; it must be 0 0 1",
                          turned ? " (it stands column by column)" : "");
}

Status check_scale(Json& known) {
  // Of 16-bit depth, smaller units end at 0.13 m; none is larger than a metre.
  constexpr double kMin_mm = 0.002, kMax_mm = 1000;
  const double scale = known.value("depth_scale", 1.0);
  if (!std::isfinite(scale) || scale <= 0) {
    return invalid_argument("depth_scale is ", scale, "; it must be positive");
  }
  if (scale >= kMin_mm && scale <= kMax_mm) return {};
  known["depth_scale"] = scale < kMin_mm ? 1000 * scale : 1000 / scale;
  return invalid_argument(
      "depth_scale is ", scale, "; it must be millimetres of one unit, ", kMin_mm, " to ", kMax_mm,
      scale < kMin_mm ? ": not metres of one unit" : ": not units of one metre");
}

Result<CameraFile> camera_of_known(Json& known) {
  if (known.value("binning", 1.0) > 1) {
    return Status(StatusCode::unsupported,
                  concat("it has a binning of ", known.at("binning").dump(),
                         "; it must be 0 or 1: give the camera of the "
                         "images as they are"));
  }
  std::optional<Camera> rectified;
  if (const std::vector<double> p = numbers_of(known.value("projection", Json::array()));
      p.size() == 12 && p[0] > 0) {
    rectified = Camera{0, 0, p[0], p[5], p[2], p[6]};
    const bool alone =
        !known.contains("fx") && !known.contains("rows") && !known.contains("columns");
    if (alone) known["rows"] = known.at("projection");
  }
  if (known.contains("rows") || known.contains("columns")) {
    if (Status status = read_matrix(known); !status.ok()) return status;
  }
  CameraFile file;
  Camera& camera = file.camera;
  camera = {0, 0, known.at("fx"), known.at("fy"), known.at("cx"), known.at("cy")};
  for (const auto& [field, value] : {std::pair("fx", camera.fx), std::pair("fy", camera.fy)}) {
    if (std::isfinite(value) && value > 0) continue;
    return invalid_argument(field, " is ", value, "; it must be positive");
  }
  if (known.contains("size")) {
    known["width"] = known.at("size").at(0);
    known["height"] = known.at("size").at(1);
  }
  camera.width = whole_number(known, "width", 0);
  camera.height = whole_number(known, "height", 0);
  if (camera.width != 0 || camera.height != 0) {
    if (Status status = validate(camera); !status.ok()) return status;
  }
  if (rectified) {
    rectified->width = camera.width;
    rectified->height = camera.height;
    file.rectified = rectified;
  }
  if (Status status = check_scale(known); !status.ok()) return status;
  file.depth_scale_mm = known.value("depth_scale", 1.0);
  if (known.contains("distortion")) file.distortion = numbers_of(known.at("distortion"));
  if (known.contains("model") && known.at("model").is_string()) {
    known.at("model").get_to(file.distortion_model);
  }
  return file;
}

Result<CameraFile> only_camera(FoundCameras& found) {
  if (found.cameras.empty()) {
    return corrupt("it has no fx and no camera matrix; it has: ", listed(found.all));
  }
  auto& [name, camera] = found.cameras.front();
  for (const auto& [other, another] : found.cameras) {
    if (another == camera) continue;
    return invalid_argument("it has ", found.cameras.size(), " cameras that differ (", name, ", ",
                            other, "); it must have one");
  }
  return camera_of_known(camera);
}

/// Numbers and what stands between them in lists. Nothing for another text.
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

Result<Json> json_of_text(const std::string& path, std::string text) {
  if (const auto numbers = bare_numbers(text)) {
    // Nine numbers are a matrix, or fx fy cx cy and the distortion of plumb_bob, as of TUM.
    const std::vector<double>& n = *numbers;
    if (n.size() != 9 || n[1] == 0 || n[3] == 0) return Json{{"k", n}};
    return Json{{"k", std::vector(n.begin(), n.begin() + 4)},
                {"d", std::vector(n.begin() + 4, n.end())}};
  }
  if (text.find_first_not_of(" \t\r\n") == text.find('{')) return parse_json(path, text);
  // OpenCV's first line, which is no YAML.
  if (text.starts_with("%YAML:")) text.erase(0, text.find('\n'));
  return json_of(parse_yaml(text));
}

/// The form that is accepted, with the numbers that are known.
std::string accepted_form(const Json& known) {
  std::string text;
  for (const char* key : {"fx", "fy", "cx", "cy", "width", "height", "depth_scale"}) {
    const bool scale = std::string_view(key) == "depth_scale";
    text += concat(text.empty() ? "{\"" : ", \"", key, "\": ",
                   known.contains(key) ? written(known.at(key))
                   : scale             ? "1"
                                       : "...");
  }
  return text + "}";
}

}  // namespace

Result<CameraFile> camera_of(const Json& json, const std::string& name) {
  FoundCameras found;
  look_for_cameras("", json, Json::object(), found);
  Result<CameraFile> file = with_json(name, [&] { return only_camera(found); });
  if (file.ok()) {
    file->unread.assign(found.unread.begin(), found.unread.end());
    return file;
  }
  Status status = file.status();
  if (!status.message.starts_with(name)) status.message.insert(0, name + ": ");
  const Json known = found.cameras.empty() ? Json::object() : found.cameras.front().second;
  status.message += ". Accepted is " + accepted_form(known);
  return status;
}

Result<CameraFile> read_camera(const std::string& path) {
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  const Result<Json> json = with_json(path, [&] { return json_of_text(path, *bytes); });
  if (json.ok()) return camera_of(*json, path);
  return Status(json.status().code,
                json.status().message + ". Accepted is " + accepted_form(Json::object()));
}

Result<std::vector<double>> plumb_bob_of(const CameraFile& file) {
  Result<Lens> lens = lens_of(file.distortion_model, file.distortion);
  if (!lens.ok()) return lens.status();
  if (!lens->equidistant) return std::move(lens->coefficients);
  return Status(StatusCode::unsupported,
                "distortion model is \"" + file.distortion_model +
                    "\"; it must be plumb_bob or rational_polynomial here");
}

std::vector<std::string> notes_of(const CameraFile& file, const char* distortion) {
  std::vector<std::string> notes;
  if (!file.unread.empty()) notes.push_back("does not read: " + listed(file.unread));
  if (std::ranges::any_of(file.distortion, [](double d) { return d != 0; })) {
    notes.push_back(concat("its distortion ", distortion));
  }
  return notes;
}

std::string camera_json(const Camera& camera, double depth_scale_mm) {
  const Json json = {{"cx", camera.cx},      {"cy", camera.cy}, {"depth_scale", depth_scale_mm},
                     {"fx", camera.fx},      {"fy", camera.fy}, {"height", camera.height},
                     {"width", camera.width}};
  return json.dump(2) + "\n";
}

}  // namespace bpa::io
