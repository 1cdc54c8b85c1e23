// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/io/bop_dataset.hpp"
#include "core/pipeline/detector.hpp"
#include "ros/bag_frames.hpp"
#include "tools/command.hpp"

namespace bpa::cli {

/// What a detector is made of.
struct DetectorArguments {
  std::string library;                    ///< Folder of the models.
  std::string further;                    ///< Folder of models that `library` lacks; empty: none.
  std::string config;                     ///< YAML file of settings; empty: the defaults.
  std::vector<std::string> models;        ///< Names; empty: all of `library`.
  std::optional<double> min_probability;  ///< In place of scene.min_probability.
};

/// Adds --library and --config.
void add_detector_options(CLI::App& command, DetectorArguments& arguments);

/// The defaults without a file.
DetectorOptions read_detector_options(const std::string& config);

/// Reads models, with a progress bar.
std::shared_ptr<const ModelLibrary> open_library(const DetectorArguments& arguments,
                                                 int num_threads);

/// Reads settings, models and the library's score layers.
Detector open_detector(const DetectorArguments& arguments, int num_threads);

/// The arguments of bpa detect.
struct DetectArguments {
  CommonOptions common;
  DetectorArguments detector;
  std::vector<std::string> pcd, depth, color;
  double cloud_unit = 0;  ///< Metres of one unit of --pcd; 0: told from the depths.
  std::string camera;
  std::string bag;  ///< A recording of ROS 2.
  ros::BagTopics bag_topics;
  double bag_start_s = 0;
  bool rectified = false;  ///< The images of --camera are.
  DatasetOptions dataset;
  std::vector<int> images;  ///< im_id, of each scene; empty: all.
  std::string priors, mask;
  std::vector<int> roi;
  int fuse = 1;
  int views = 1;      ///< Frames that are joined into one scene.
  std::string poses;  ///< JSON file of the cameras' poses; empty: those of the data set.
  bool follow = false;
  int top = 20;
  double budget_ms = 0;
  std::string csv, json, annotate, explain;
};

/// Adds --pcd, --unit, --depth, --color, --camera, --bop, --split, --scenes and --images.
void add_input_options(CLI::App& command, DetectArguments& arguments);
/// How many of --pcd, --depth and --bop are given; throws a ParseError unless there is one colour
/// image for each depth image, or none.
int count_inputs(const DetectArguments& arguments);

/// A frame, and the frame of reference that its poses are reported in.
struct Input {
  std::string name;  ///< For people.
  Frame frame;       ///< Its depth is clean.
  Pose reported_from_camera;
};

/// The frames that the arguments name, by scene and image number. Frames of no data set are the
/// images of scene 0; the path of a PCD cloud is in depth_path.
std::vector<io::BopFrame> list_inputs(const DetectArguments& arguments);

/// Reads one of list_inputs(). The depth of read_raw_input() may hold anything.
Input read_raw_input(const DetectArguments& arguments, const io::BopFrame& entry);
Input read_input(const DetectArguments& arguments, const io::BopFrame& entry);

/// A frame with truth; nothing is owned.
struct TrueFrame {
  std::size_t index;   ///< Among all frames of the split, from 0.
  const Frame& frame;  ///< Its depth is clean.
  const std::vector<io::BopInstance>& truth;
};

/// A request for all models.
DetectRequest request_of(const CommonOptions& common);

/// Gives the truth of frames the numbers that the library has for its objects, by name where data
/// set and library have names. Objects that the library lacks get -1, and are named in a warning if
/// `library` is a whole one.
void number_truth(const std::string& dataset, const ModelLibrary& library, bool whole,
                  std::vector<io::BopFrame>& frames);

/// Reads the frames of a split that have truth, with a progress bar, and hands over each; with
/// a library, their truth is numbered by number_truth(). Those that cannot be read are left out
/// with a warning.
void read_true_frames(const DatasetOptions& dataset,
                      const std::function<void(const TrueFrame&)>& use,
                      const ModelLibrary* library = nullptr);

/// The same for frames that the detector has searched, each for `max_models` random models of the
/// library; 0: for all.
using UseSearched =
    std::function<void(const TrueFrame&, const SceneInterpretations&, const FrameTrace&)>;
void search_frames(const Detector& detector, const DatasetOptions& dataset,
                   const CommonOptions& common, const UseSearched& use, int max_models = 0);

}  // namespace bpa::cli
