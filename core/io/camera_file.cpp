// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// One reader of all forms. Text becomes JSON (camera_text.cpp); the keys that people write become
// ours; and these become a camera.
#include "core/io/camera_file.hpp"

#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>

#include "core/base/concat.hpp"
#include "core/geometry/lens.hpp"
#include "core/io/private/camera_text.hpp"
#include "core/io/private/json_file.hpp"

namespace bpa::io {
namespace {

/// What keys mean here, and the keys, in lower case, letters and digits alone. Those without a
/// meaning say nothing of a pinhole. A matrix of "columns" may stand column by column.
constexpr std::pair<const char*, const char*> kCameraKeys[] = {
    {"fx", " fx flx "},
    {"fy", " fy fly "},
    {"cx", " cx ppx "},
    {"cy", " cy ppy "},
    {"focal", " focallength "},
    {"principal", " principalpoint "},
    {"rows", " k camk cameramatrix intrinsics intrinsic mtx params "},
    {"columns", " intrinsicmatrix "},
    {"width", " width imagewidth w "},
    {"height", " height imageheight h "},
    {"size", " resolution imagesize "},
    {"depth_scale", " depthscale "},
    {"per_metre", " depthmapfactor "},
    {"k1", " k1 "},
    {"k2", " k2 "},
    {"p1", " p1 "},
    {"p2", " p2 "},
    {"k3", " k3 "},
    {"k4", " k4 "},
    {"lens", " cameramodel type "},
    {"distortion", " d distcoeffs distortioncoeffs distortioncoefficients dist distortion coeffs "},
    {"model", " distortionmodel model "},
    {"projection", " p projection projectionmatrix "},
    {"binning", " binningx binningy "},
    {"roi", " roi "},
    {"",
     " header cameraname name r rectification rectificationmatrix classname versionmajor "
     "versionminor extrinsic camrw2c camtw2c stampns rows cols dt typeid "}};

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

void append_numbers(const Json& json, std::vector<double>& numbers) {
  if (!json.is_array()) return numbers.push_back(json.get<double>());
  for (const Json& one : json) append_numbers(one, numbers);
}

std::vector<double> numbers_of(const Json& json) {
  std::vector<double> numbers;
  append_numbers(json, numbers);
  return numbers;
}

/// Keeps a value under our key. Numbers may stand as text; pairs are two keys of ours.
void keep(const std::string& meaning, const Json& data, Json& known) {
  Json value = data;
  if (data.is_string()) {
    const auto numbers = bare_numbers(data.get<std::string>());
    if (numbers && numbers->size() == 1) value = numbers->front();
    if (numbers && numbers->size() > 1) value = *numbers;
  }
  const bool focal = meaning == "focal";
  if (!focal && meaning != "principal") {
    known[meaning] = value;
    return;
  }
  if (!value.is_number() && !value.is_array()) return;
  const std::vector<double> two = numbers_of(value);
  if (two.empty() || two.size() > 2) return;
  known.emplace(focal ? "fx" : "cx", two.front());
  known.emplace(focal ? "fy" : "cy", two.back());
}

bool holds_objects(const Json& json) {
  return json.is_object() || (json.is_array() && !json.empty() && json.front().is_object());
}

/// Of a key such as Camera.fx (ORB-SLAM): what stands before its last dot, if it is one camera's.
std::string camera_of_key(const std::string& key, const std::string& meaning) {
  const std::size_t dot = key.rfind('.');
  const bool shared = meaning == "width" || meaning == "height" || meaning == "per_metre";
  return dot == key.npos || shared ? "" : key.substr(0, dot);
}

void look_for_cameras(const std::string& name, const Json& json, Json known, FoundCameras& found) {
  if (!holds_objects(json)) return;
  std::map<std::string, Json> inner;
  for (const auto& [key, value] : json.items()) {
    const Json& data = value.is_object() && value.contains("data") ? value.at("data") : value;
    const char* meaning = json.is_array() ? nullptr : meaning_of(key.substr(key.rfind('.') + 1));
    if (json.is_object()) found.all.insert(key);
    const bool is_roi = meaning != nullptr && std::string_view(meaning) == "roi";
    if (holds_objects(data) && !is_roi) {
      if (meaning == nullptr || *meaning != 0) inner[key] = data;
    } else if (meaning == nullptr) {
      if (json.is_object()) found.unread.insert(key);
    } else if (const std::string camera = camera_of_key(key, meaning); !camera.empty()) {
      inner[camera][key.substr(camera.size() + 1)] = data;
    } else if (*meaning != 0) {
      keep(meaning, data, known);
    }
  }
  const auto has = [&](const char* key) { return known.contains(key); };
  if (has("fx") || has("fy") || has("rows") || has("columns") || has("projection")) {
    found.cameras.emplace_back(name, std::move(known));
    for (const auto& [key, value] : inner) found.unread.insert(key);
    return;
  }
  for (const auto& [key, value] : inner) look_for_cameras(key, value, known, found);
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
  if (known.contains("per_metre")) {
    known["depth_scale"] = 1000 / known.at("per_metre").get<double>();
  }
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

/// As the server does of a camera_info.
Status check_whole(const Json& known) {
  constexpr const char* kRemedy = ": give the camera of the images as they are";
  if (known.value("binning", 1.0) > 1) {
    return Status(
        StatusCode::unsupported,
        concat("it has a binning of ", known.at("binning").dump(), "; it must be 0 or 1", kRemedy));
  }
  const Json roi = known.value("roi", Json::object());
  const auto differs = [&](const char* key, const Json& whole) {
    const Json value = roi.is_object() ? roi.value(key, Json(0)) : Json(0);
    return value != 0 && value != whole;
  };
  if (!differs("x_offset", 0) && !differs("y_offset", 0) &&
      !differs("width", known.value("width", Json(0))) &&
      !differs("height", known.value("height", Json(0)))) {
    return {};
  }
  return Status(StatusCode::unsupported, concat("it has the roi ", written(roi),
                                                "; it must be empty or the whole image", kRemedy));
}

/// k1 k2 p1 p2 k3, or k1 k2 k3 k4 of a fisheye lens, that stand under keys of their own.
void gather_distortion(Json& known) {
  std::string lens = known.contains("lens") ? known.at("lens").dump() : "";
  std::ranges::transform(lens, lens.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool fisheye = lens.find("fish") != lens.npos || lens.find("kannala") != lens.npos;
  if (fisheye) known.emplace("model", "equidistant");
  if (known.contains("distortion") || !known.contains("k1")) return;
  for (const char* key : {"k1", "k2", "p1", "p2", "k3", "k4"}) {
    const bool tangential = *key == 'p';
    if (fisheye ? tangential : key == std::string_view("k4")) continue;
    known["distortion"].push_back(known.value(key, 0.0));
  }
}

Result<CameraFile> camera_of_known(Json& known) {
  if (Status status = check_whole(known); !status.ok()) return status;
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
  gather_distortion(known);
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
  Result<CameraFile> file = with_json(name, [&] {
    look_for_cameras("", json, Json::object(), found);
    return only_camera(found);
  });
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
