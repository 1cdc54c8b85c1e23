// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/mesh_input.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "core/base/concat.hpp"

namespace bpa::cli {
namespace {

struct LengthUnit {
  const char* option;
  const char* name;
  double metres;
};

constexpr LengthUnit kMetre{"m", "metres", 1};
constexpr LengthUnit kCentimetre{"cm", "centimetres", 0.01};
constexpr LengthUnit kMillimetre{"mm", "millimetres", 0.001};
constexpr LengthUnit kInch{"in", "inches", 0.0254};
constexpr LengthUnit kUnits[] = {kMetre, kCentimetre, kMillimetre, kInch};

/// Things as long, metres.
constexpr std::pair<double, const char*> kThings[] = {
    {0.01, "a pea"},  {0.03, "a coin"}, {0.08, "an egg"}, {0.15, "a mug"},      {0.3, "a shoe"},
    {0.6, "a crate"}, {1.2, "a table"}, {3.0, "a car"},   {HUGE_VAL, "a house"}};

Eigen::Vector3f size_of(const std::vector<Eigen::Vector3f>& points) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : points) box.extend(point);
  return box.isEmpty() ? Eigen::Vector3f(0, 0, 0) : Eigen::Vector3f(box.sizes());
}

const LengthUnit& guess(double largest) {
  constexpr double kLargestMetres = 3;         // the largest model, metres
  constexpr double kSmallestMillimetres = 20;  // smaller objects are rare; 3 to 20 cm are not
  if (largest <= kLargestMetres) return kMetre;
  return largest < kSmallestMillimetres ? kCentimetre : kMillimetre;
}

/// Throws where the assumed size is seldom that of an object, and says what else it may be.
void check_assumption(const std::string& path, const LengthUnit& unit, double side) {
  constexpr double kShortest = 0.01, kLongest = 0.8;  // metres
  if (unit.metres * side >= kShortest && unit.metres * side <= kLongest) return;
  std::string choices;
  for (const LengthUnit& other : kUnits) {
    choices += concat(choices.empty() ? "" : ", ", "--unit ", other.option,
                      format(1000 * other.metres * side < 10 ? " (%.2g mm)" : " (%.0f mm)",
                             1000 * other.metres * side));
  }
  throw Failure(invalid_argument(path, " does not say its unit, and its longest side is ", side,
                                 "; give one of ", choices));
}

void print_assumption(const std::string& path, const LengthUnit& unit,
                      const std::vector<Eigen::Vector3f>& points) {
  const Eigen::Vector3d mm = (1000 * size_of(points)).cast<double>();
  const auto* like = std::ranges::find_if(
      kThings, [&](const auto& thing) { return mm.maxCoeff() <= 1000 * thing.first; });
  std::printf("%s: assuming %s: %.0f x %.0f x %.0f mm, like %s; --unit or --scale says otherwise\n",
              std::filesystem::path(path).filename().c_str(), unit.name, mm.x(), mm.y(), mm.z(),
              like->second);
  std::fflush(stdout);  // before the work
}

}  // namespace

void add_unit_options(CLI::App& command, double& scale) {
  auto* factor = command.add_option("--scale", scale,
                                    "Metres of one unit of the file, 0.001 for millimetres; of "
                                    "glTF and DAE, a factor on the metres that the file says");
  factor->check(CLI::PositiveNumber);
  add_unit_option(command, scale,
                  "The same by name. Guessed from the size of the object if neither is given")
      ->excludes(factor);
}

CLI::Option* add_unit_option(CLI::App& command, double& metres, const char* text) {
  const auto set = [&metres](const std::string& name) {
    const auto* unit =
        std::ranges::find(kUnits, name, [](const LengthUnit& u) { return std::string(u.option); });
    metres = unit->metres;
  };
  return command.add_option_function<std::string>("--unit", set, text)
      ->check(CLI::IsMember({"m", "cm", "mm", "in"}));
}

void assume_metres(const std::string& path, const std::vector<Eigen::Vector3f>& points) {
  check_assumption(path, kMetre, static_cast<double>(size_of(points).maxCoeff()));
  print_assumption(path, kMetre, points);
}

double guess_unit(double largest) { return guess(largest).metres; }

std::vector<io::MeshFile> read_meshes(const std::vector<std::string>& paths, double& scale) {
  std::vector<io::MeshFile> files;
  double largest = 0;
  std::string path_of_largest;
  for (const std::string& path : paths) {
    files.push_back(or_throw(io::read_mesh_file(path, scale > 0 ? scale : 1.0)));
    const auto side = static_cast<double>(size_of(files.back().mesh.vertices).maxCoeff());
    if (files.back().metres || side <= largest) continue;
    largest = side;
    path_of_largest = path;
  }
  if (scale > 0 || largest == 0) return files;
  const LengthUnit& unit = guess(largest);
  check_assumption(path_of_largest, unit, largest);
  scale = unit.metres;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (files[i].metres) continue;
    for (Eigen::Vector3f& vertex : files[i].mesh.vertices) {
      vertex = (scale * vertex.cast<double>()).cast<float>();
    }
    print_assumption(paths[i], unit, files[i].mesh.vertices);
  }
  return files;
}

}  // namespace bpa::cli
