// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/private/model_description.hpp"

#include "core/io/model_file.hpp"
#include "core/io/private/json_fields.hpp"

namespace bpa {

NLOHMANN_JSON_SERIALIZE_ENUM(SymmetryOrigin, {{SymmetryOrigin::none, "none"},
                                              {SymmetryOrigin::declared, "declared"},
                                              {SymmetryOrigin::found, "found"}})

static void fields(auto& visit, io::Is<ContinuousSymmetry> auto& symmetry) {
  visit("axis", symmetry.axis);
  visit("point_m", symmetry.point);
}

static void fields(auto& visit, io::Is<NoiseCurve> auto& curve) {
  visit("floor", curve.floor);
  visit("edge_height", curve.edge_height);
  visit("edge_place_m", curve.edge_place);
  visit("edge_width_m", curve.edge_width);
  visit("angle_height", curve.angle_height);
  visit("angle_place", curve.angle_place);
  visit("angle_width", curve.angle_width);
}

static void fields(auto& visit, io::Is<NoiseModel> auto& noise) {
  visit("range_m", noise.range);
  visit("normal_rad", noise.normal);
  visit("depth_m", noise.depth);
  visit("fitted", noise.fitted);
}

namespace io {
namespace {

constexpr const char* kFormat = "bpa model";

}  // namespace

static void fields(auto& visit, Is<FileRecord> auto& record) {
  visit("bytes", record.bytes);
  visit("crc32", record.crc32);
}

static void fields(auto& visit, Is<ModelDescription> auto& description) {
  auto& model = description.model;
  visit("name", model.name);
  visit("number", model.number);
  visit("source", model.source);
  visit("diameter_m", model.diameter);
  visit("complete", model.complete);
  visit.group("symmetries", [&model](auto group) {
    group("origin", model.symmetry_origin);
    group("discrete", model.symmetry.discrete);
    group("continuous", model.symmetry.continuous);
  });
  visit("noise", model.noise);
  visit("warnings", model.warnings);
  visit("points", description.points);
  visit("files", description.files);
}

std::string description_text(const ModelDescription& description) {
  Json json = description;
  json["format"] = kFormat;
  json["version"] = kModelFileVersion;
  return json.dump(1) + "\n";
}

Result<ModelDescription> read_description(const std::string& path) {
  const Result<Json> json = read_json(path);
  if (!json.ok()) return json.status();
  return with_json(path, [&]() -> Result<ModelDescription> {
    if (json->value("format", "") != kFormat) {
      return Status(StatusCode::corrupt, path + " is not a model of this program");
    }
    const int version = json->at("version").get<int>();
    if (version == kModelFileVersion) return json->get<ModelDescription>();
    return Status(StatusCode::corrupt, path + " has format version " + std::to_string(version) +
                                           "; this program reads version " +
                                           std::to_string(kModelFileVersion) +
                                           ": make the model again (bpa model from-mesh, "
                                           "from-bop or from-scans)");
  });
}

}  // namespace io
}  // namespace bpa
