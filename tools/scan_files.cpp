// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/scan_files.hpp"

#include <filesystem>

#include "core/io/bop_dataset.hpp"
#include "core/io/image_file.hpp"
#include "tools/progress.hpp"

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

}  // namespace

AlignedScan align_scan_of(const std::string& dataset, const std::string& split, double step_deg,
                          const CommonOptions& common) {
  const std::vector<io::BopFrame> frames = or_throw(io::read_bop_frames(dataset, split));
  std::vector<ScanView> views(frames.size());
  run_all("images", static_cast<int>(frames.size()), common.threads, [&](int k) {
    const auto i = static_cast<std::size_t>(k);
    views[i].view = make_posed_view(or_throw(io::load_bop_frame(frames[i])), {}, Pose{});
    views[i].view.id = k;
    views[i].step = frames[i].im_id;
  });
  std::vector<std::vector<ScanView>> positions;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i == 0 || frames[i].scene_id != frames[i - 1].scene_id) positions.emplace_back();
    positions.back().push_back(std::move(views[i]));
  }
  const ScanOptions options{
      .step_deg = step_deg, .seed = common.seed, .num_threads = common.threads};
  Progress progress("scan", 2);
  progress.show(0, "centres of rotation");
  return or_throw(align_scan(std::move(positions), options), dataset);
}

std::vector<PosedView> read_posed_views(const std::string& dataset, const std::string& split,
                                        int obj_id, int num_threads) {
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
  std::vector<PosedView> views(wanted.size());
  run_all("images", static_cast<int>(wanted.size()), num_threads, [&](int k) {
    const auto& [entry, instance] = wanted[static_cast<std::size_t>(k)];
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
    PosedView& view = views[static_cast<std::size_t>(k)];
    view = make_posed_view(frame, mask, entry->truth[instance].camera_from_object);
    view.id = k;
  });
  return views;
}

}  // namespace bpa::cli
