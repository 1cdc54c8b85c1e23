// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "tools/scan_files.hpp"

#include <cstdio>
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
  char name[40];
  std::snprintf(name, sizeof name, "_%06zu.png", instance);
  return (depth.parent_path().parent_path() / "mask_visib" / (depth.stem().string() + name))
      .string();
}

}  // namespace

Result<std::vector<std::vector<ScanView>>> read_scan(const std::string& dataset,
                                                     const std::string& split, int num_threads) {
  const auto frames = io::read_bop_frames(dataset, split);
  if (!frames.ok()) return frames.status();
  std::vector<ScanView> views(frames->size());
  const Status status =
      run_all("images", static_cast<int>(frames->size()), num_threads, [&](int k) -> Status {
        const auto i = static_cast<std::size_t>(k);
        const Result<Frame> frame = io::load_bop_frame((*frames)[i]);
        if (!frame.ok()) return frame.status();
        views[i].view = make_posed_view(*frame, {}, Pose{});
        views[i].step = (*frames)[i].im_id;
        views[i].view.id = static_cast<int>(i);
        return {};
      });
  if (!status.ok()) return status;
  std::vector<std::vector<ScanView>> positions;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (i == 0 || (*frames)[i].scene_id != (*frames)[i - 1].scene_id) positions.emplace_back();
    positions.back().push_back(std::move(views[i]));
  }
  return positions;
}

Result<std::vector<PosedView>> read_posed_views(const std::string& dataset,
                                                const std::string& split, int obj_id,
                                                int num_threads) {
  const auto frames = io::read_bop_frames(dataset, split);
  if (!frames.ok()) return frames.status();
  struct Wanted {
    const io::BopFrame* frame;
    std::size_t instance;
  };
  std::vector<Wanted> wanted;
  for (const io::BopFrame& frame : *frames) {
    for (std::size_t k = 0; k < frame.truth.size(); ++k) {
      if (frame.truth[k].obj_id == obj_id) wanted.push_back({&frame, k});
    }
  }
  if (wanted.empty()) {
    return Status(StatusCode::not_found, dataset + "/" + split + " shows no object " +
                                             std::to_string(obj_id) + " with its pose");
  }
  std::vector<PosedView> views(wanted.size());
  const Status status =
      run_all("images", static_cast<int>(wanted.size()), num_threads, [&](int k) -> Status {
        const auto i = static_cast<std::size_t>(k);
        const Wanted& w = wanted[i];
        const Result<Frame> frame = io::load_bop_frame(*w.frame);
        if (!frame.ok()) return frame.status();
        std::vector<std::uint8_t> mask;
        std::error_code error;
        if (const std::string path = mask_path(*w.frame, w.instance); fs::exists(path, error)) {
          const auto image = io::read_gray_png(path);
          if (!image.ok()) return image.status();
          if (image->width != frame->camera.width || image->height != frame->camera.height) {
            return Status(StatusCode::corrupt, path + " is not as large as its frame");
          }
          for (const auto value : image->pixels) mask.push_back(value != 0);
        }
        views[i] = make_posed_view(*frame, mask, w.frame->truth[w.instance].camera_from_object);
        views[i].id = static_cast<int>(i);
        return {};
      });
  if (!status.ok()) return status;
  return views;
}

}  // namespace bpa::cli
