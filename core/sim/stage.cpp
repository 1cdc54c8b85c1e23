// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/sim/private/stage.hpp"

#include <iterator>

namespace bpa::sim {

Stage::Stage(std::vector<SimulatedObject> objects, int num_threads,
             std::vector<SimulatedObject> look_alikes)
    : impl_(std::make_unique<Impl>()) {
  impl_->objects = std::move(objects);
  impl_->distractors = make_distractors(num_threads);
  std::move(look_alikes.begin(), look_alikes.end(), std::back_inserter(impl_->distractors));
  impl_->tables = make_tables();
  impl_->room = make_room();
  impl_->bin = make_bin();
  std::vector<const TriangleMesh*> meshes;
  for (const SimulatedObject& object : impl_->objects) meshes.push_back(&object.mesh);
  impl_->first_distractor = static_cast<int>(meshes.size());
  for (const SimulatedObject& object : impl_->distractors) meshes.push_back(&object.mesh);
  impl_->first_table = static_cast<int>(meshes.size());
  for (const SimulatedObject& object : impl_->tables) meshes.push_back(&object.mesh);
  impl_->room_mesh = static_cast<int>(meshes.size());
  meshes.push_back(&impl_->room.mesh);
  impl_->bin_mesh = static_cast<int>(meshes.size());
  meshes.push_back(&impl_->bin.mesh);
  impl_->ray_meshes = std::make_unique<RayMeshes>(meshes);
}
Stage::~Stage() = default;
Stage::Stage(Stage&&) noexcept = default;
Stage& Stage::operator=(Stage&&) noexcept = default;

const std::vector<SimulatedObject>& Stage::objects() const { return impl_->objects; }

SimulatedFrame capture(const KinectView& view, const std::vector<int>& objects,
                       const KinectOptions& options, std::uint64_t seed, int shot,
                       int num_threads) {
  KinectImage image = simulate_kinect(view, options, seed, shot, num_threads);
  SimulatedFrame frame;
  frame.frame = std::move(image.frame);
  frame.camera_from_world = view.world_from_camera.inverse();
  const int count = static_cast<int>(objects.size());
  const std::vector<InstanceVisibility> seen =
      visibility(view.scene, image.ideal, view.camera, view.world_from_camera, count, num_threads);
  for (int i = 0; i < count; ++i) {
    frame.instances.push_back(
        {objects[i], frame.camera_from_world * view.scene.instances()[i].world_from_mesh, seen[i]});
  }
  frame.instance_image.reserve(image.ideal.instance.size());
  for (const std::int32_t instance : image.ideal.instance) {
    frame.instance_image.push_back(static_cast<std::int16_t>(instance < count ? instance : -1));
  }
  frame.ideal_depth = std::move(image.ideal.depth);
  return frame;
}

std::vector<std::uint8_t> visible_mask(const SimulatedFrame& frame, int instance) {
  std::vector<std::uint8_t> mask;
  mask.reserve(frame.instance_image.size());
  for (const std::int16_t i : frame.instance_image) mask.push_back(i == instance ? 255 : 0);
  return mask;
}

}  // namespace bpa::sim
