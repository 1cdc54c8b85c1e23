// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/posed_views.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/base/random.hpp"
#include "core/cloud/join_vertices.hpp"
#include "core/geometry/sphere_directions.hpp"
#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "core/sim/kinect.hpp"

namespace bpa::cli {
namespace fs = std::filesystem;
namespace {

/// Where the instance's pixels are marked: SCENE/mask_visib/IMAGE_INSTANCE.png beside SCENE/depth.
std::string mask_path(const io::BopFrame& frame, std::size_t instance) {
  const fs::path depth(frame.depth_path);
  const std::string number = io::bop_number(static_cast<int>(instance));
  return depth.parent_path().parent_path() / "mask_visib" /
         (depth.stem().string() + "_" + number + ".png");
}

// A square of the edges 2 u and 2 v about origin + normal.
void add_square(TriangleMesh& mesh, const Eigen::Vector3f& origin, const Eigen::Vector3f& normal,
                const Eigen::Vector3f& u, const Eigen::Vector3f& v) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& corner : std::initializer_list<Eigen::Vector3f>{
           normal - u - v, normal + u - v, normal + u + v, normal - u + v}) {
    mesh.vertices.push_back(origin + corner);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// The inside of a cube: what lies behind the object.
TriangleMesh room(float half, const Eigen::Vector3f& middle) {
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-half, half}) {
      add_square(mesh, middle, side * Eigen::Vector3f::Unit(axis),
                 half * Eigen::Vector3f::Unit((axis + 1) % 3),
                 half * Eigen::Vector3f::Unit((axis + 2) % 3));
    }
  }
  return mesh;
}

// A mask of the pixels that measured something in the box or a little beside it.
std::vector<std::uint8_t> near(const Frame& frame, const Pose& box_from_camera,
                               const Eigen::AlignedBox3f& box) {
  constexpr float kBeside = 0.015f;  // metres: what a sensor may be off by
  const Eigen::Vector3f low = box.min().array() - kBeside, high = box.max().array() + kBeside;
  const Eigen::AlignedBox3f inside(low, high);
  std::vector<std::uint8_t> mask(frame.depth.size(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    if (!(frame.depth[i] > 0)) continue;
    const int u = static_cast<int>(i) % frame.camera.width;
    const int v = static_cast<int>(i) / frame.camera.width;
    const Eigen::Vector3d p = box_from_camera * frame.camera.unproject(u, v, frame.depth[i]);
    mask[i] = inside.contains(p.cast<float>());
  }
  return mask;
}

// Marks the pixels up to `reach` beside a marked one, in x and in y.
void widen(std::vector<std::uint8_t>& mask, int width, int height, int reach) {
  std::vector<std::uint8_t> out(mask.size(), 0);
  // One line of `count` pixels that are `step` apart: marks reach forward, then backward.
  const auto widen_line = [&](int begin, int count, int step) {
    int forth = 0, back = 0;
    for (int k = 0; k < count; ++k) {
      const int i = begin + k * step, j = begin + (count - 1 - k) * step;
      forth = mask[i] ? reach + 1 : forth - 1;
      back = mask[j] ? reach + 1 : back - 1;
      if (forth > 0) out[i] = 1;
      if (back > 0) out[j] = 1;
    }
  };
  for (int y = 0; y < height; ++y) widen_line(y * width, width, 1);
  mask = out;
  for (int x = 0; x < width; ++x) widen_line(x, height, width);
  mask = std::move(out);
}

// Marks at least the pixels that show a mesh, and those up to `reach` pixels beside them.
std::vector<std::uint8_t> outline(const TriangleMesh& mesh, const Pose& camera_from_mesh,
                                  const Camera& camera, int reach) {
  std::vector<Eigen::Vector2i> pixels;
  pixels.reserve(mesh.vertices.size());
  for (const Eigen::Vector3f& v : mesh.vertices) {
    const Eigen::Vector2d p = camera.project(camera_from_mesh * v.cast<double>());
    pixels.emplace_back(p.array().round().cast<int>());
  }
  std::vector<std::uint8_t> mask(camera.width * camera.height, 0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Eigen::Vector2i low = pixels[a].cwiseMin(pixels[b]).cwiseMin(pixels[c]).cwiseMax(0);
    const Eigen::Vector2i high = pixels[a].cwiseMax(pixels[b]).cwiseMax(pixels[c]);
    for (int y = low.y(); y <= std::min(high.y(), camera.height - 1); ++y) {
      for (int x = low.x(); x <= std::min(high.x(), camera.width - 1); ++x) {
        mask[y * camera.width + x] = 1;
      }
    }
  }
  widen(mask, camera.width, camera.height, reach);
  return mask;
}

Pose look_from(const Eigen::Vector3d& direction, double distance, const Eigen::Vector3d& at) {
  Eigen::Matrix3d axes;  // columns: right, down, forward, of the camera in the object's frame
  axes.col(2) = -direction;
  axes.col(0) = direction.unitOrthogonal();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Pose::from_matrix(axes, at + distance * direction);
}

}  // namespace

modeling::AlignedScan align_scan_of(const std::string& dataset, const std::string& split,
                                    double step_deg, const CommonOptions& common) {
  const std::vector<io::BopFrame> frames = or_throw(io::read_bop_frames(dataset, split));
  std::vector<modeling::ScanView> views(frames.size());
  run_all("images", static_cast<int>(frames.size()), common.threads, [&](int i) {
    views[i].view = modeling::make_posed_view(or_throw(io::load_bop_frame(frames[i])), {}, Pose{});
    views[i].view.id = i;
    views[i].step = frames[i].im_id;
  });
  std::vector<std::vector<modeling::ScanView>> positions;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i == 0 || frames[i].scene_id != frames[i - 1].scene_id) positions.emplace_back();
    positions.back().push_back(std::move(views[i]));
  }
  const modeling::ScanOptions options{
      .step_deg = step_deg, .seed = common.seed, .num_threads = common.threads};
  Progress progress("scan", 2);
  progress.show(0, "centres of rotation");
  return or_throw(modeling::align_scan(std::move(positions), options), dataset);
}

std::vector<modeling::PosedView> read_posed_views(const std::string& dataset,
                                                  const std::string& split, int obj_id,
                                                  int num_threads) {
  const std::vector<io::BopFrame> frames = or_throw(io::read_bop_frames(dataset, split));
  struct Wanted {
    const io::BopFrame* frame;
    std::size_t instance;
  };
  std::vector<Wanted> wanted;
  for (const io::BopFrame& frame : frames) {
    for (std::size_t k = 0; k < frame.truth.size(); ++k) {
      if (frame.truth[k].obj_id == obj_id) wanted.push_back({&frame, k});
    }
  }
  if (wanted.empty()) {
    throw Failure({StatusCode::not_found, dataset + "/" + split + " shows no object " +
                                              std::to_string(obj_id) + " with its pose"});
  }
  std::vector<modeling::PosedView> views(wanted.size());
  run_all("images", static_cast<int>(wanted.size()), num_threads, [&](int k) {
    const auto& [entry, instance] = wanted[k];
    const Frame frame = or_throw(io::load_bop_frame(*entry));
    std::vector<std::uint8_t> mask;
    std::error_code error;
    if (const std::string path = mask_path(*entry, instance); fs::exists(path, error)) {
      const io::GrayImage image = or_throw(io::read_gray_png(path));
      if (image.width != frame.camera.width || image.height != frame.camera.height) {
        throw Failure({StatusCode::corrupt, path + " is not as large as its frame"});
      }
      for (const auto value : image.pixels) mask.push_back(value != 0);
    }
    modeling::PosedView& view = views[k];
    view = modeling::make_posed_view(frame, mask, entry->truth[instance].camera_from_object);
    view.id = k;
  });
  return views;
}

TriangleMesh squares_of(const PointCloud& cloud) {
  const float half = mean_spacing(cloud, 0.5f);  // edges are twice as long
  TriangleMesh mesh;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f u = half * cloud.normals[i].unitOrthogonal();
    add_square(mesh, cloud.points[i], Eigen::Vector3f::Zero(), u, cloud.normals[i].cross(u));
  }
  return mesh;
}

std::vector<modeling::PosedView> simulate_views(const TriangleMesh& mesh, int count,
                                                std::uint64_t seed, int num_threads,
                                                const std::string& title) {
  constexpr double kFocal = 570.3;  // of a Kinect's depth camera
  constexpr double kDistance = 0.8, kNearest = 0.6, kMargin = 24;
  constexpr double kWidest = 560;  // pixels: large objects are seen from farther away
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& v : mesh.vertices) box.extend(v);
  const double size = box.diagonal().norm();
  const double whole = kFocal * size / (kWidest - 2 * kMargin);  // as near as all of it is seen
  const double distance = std::max(kDistance, 0.5 * size + std::max(kNearest, whole));
  // As much of the camera's image as the object covers.
  const double nearest = distance - 0.5 * size;
  const int side = 2 * static_cast<int>(std::ceil(0.5 * kFocal * size / nearest + kMargin));
  const double centre = 0.5 * (side - 1);
  const Camera camera{side, side, kFocal, kFocal, centre, centre};

  const TriangleMesh walls = room(static_cast<float>(1.7 * distance), box.center());
  const sim::RayMeshes meshes({&mesh, &walls});
  const sim::RayScene scene(meshes, {{0, Pose{}}, {1, Pose{}}});
  const sim::Shading shading{.materials = {sim::Material{}, sim::Material{}}};
  const sim::KinectOptions kinect{.registered = false};

  // Rays that pass the object farther away than its measurements scatter tell nothing of it.
  constexpr double kScatter = 0.015;  // metres
  const int reach = sim::kLookAround + static_cast<int>(std::ceil(kScatter * kFocal / nearest));

  const TriangleMesh shape = shape_of(mesh);
  std::vector<modeling::PosedView> views(static_cast<std::size_t>(count));
  run_all(title, count, num_threads, [&](int k) {
    const Pose object_from_camera =
        look_from(sphere_direction(k, count), distance, box.center().cast<double>());
    const auto wanted = outline(shape, object_from_camera.inverse(), camera, reach);
    const Frame frame = sim::simulate_depth({scene, shading, camera, object_from_camera, wanted},
                                            kinect, RandomStream(seed, k)(), 0, 1);
    views[k] = modeling::make_posed_view(frame, near(frame, object_from_camera, box),
                                         object_from_camera.inverse(), "structured_light");
  });
  return views;
}

void look_at(const TriangleMesh& mesh, int count, const CommonOptions& common,
             ModelSource& source) {
  if (count == 0) return;
  const std::string title = source.name + ", simulated views";
  modeling::keep_measured(source, simulate_views(mesh, count, common.seed, common.threads, title),
                          common.threads);
}

}  // namespace bpa::cli
