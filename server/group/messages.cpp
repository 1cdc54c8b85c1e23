// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/group/messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/options.hpp"
#include "core/io/options_yaml.hpp"
#include "idl/wire/status.hpp"

namespace bpa::server::group {
namespace {

namespace msgs = wire::bpa_msgs;

std::vector<std::string> option_texts(DetectorOptions options) {
  std::vector<std::string> out;
  for (const Option& option : options_of(options)) {
    if (!option.is_group()) out.push_back(option.path + '=' + io::value_text(option));
  }
  return out;
}

template <class T>
std::vector<std::uint8_t> bytes_of(const std::vector<T>& values) {
  std::vector<std::uint8_t> bytes(values.size() * sizeof(T));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

msgs::RgbdFrame frame_message(const Frame& frame) {
  const Camera& camera = frame.camera;
  msgs::RgbdFrame message;
  message.header.frame_id = frame.frame_id;
  message.width = static_cast<std::uint32_t>(camera.width);
  message.height = static_cast<std::uint32_t>(camera.height);
  message.color_encoding = frame.color.empty() ? "" : "rgb8";
  message.color = frame.color;
  message.depth_encoding = "32FC1";
  message.depth = bytes_of(frame.depth);
  message.k = {camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1};
  message.mask = frame.mask;
  const RegionOfInterest& roi = frame.roi;
  if (roi.empty()) return message;  // whatever else it says
  message.roi.x_offset = static_cast<std::uint32_t>(roi.x);
  message.roi.y_offset = static_cast<std::uint32_t>(roi.y);
  message.roi.width = static_cast<std::uint32_t>(roi.width);
  message.roi.height = static_cast<std::uint32_t>(roi.height);
  return message;
}

// As it was sent: depth that is none stays as it is. validate(Frame) says what is wrong.
Frame frame_from(msgs::GroupTask& task) {
  msgs::RgbdFrame& message = task.frame;
  Frame frame;
  frame.camera = {.width = static_cast<int>(message.width),
                  .height = static_cast<int>(message.height),
                  .fx = message.k[0],
                  .fy = message.k[4],
                  .cx = message.k[2],
                  .cy = message.k[5]};
  frame.frame_id = std::move(message.header.frame_id);
  frame.depth.resize(message.depth.size() / sizeof(float));
  std::copy_n(message.depth.data(), frame.depth.size() * sizeof(float),
              reinterpret_cast<std::uint8_t*>(frame.depth.data()));
  frame.color = std::move(message.color);
  frame.mask = std::move(message.mask);
  frame.background = std::move(task.background);
  frame.roi = {static_cast<int>(message.roi.x_offset), static_cast<int>(message.roi.y_offset),
               static_cast<int>(message.roi.width), static_cast<int>(message.roi.height)};
  frame.fused = static_cast<int>(task.fused_frames);
  return frame;
}

template <class Matrix, class Array>
void copy_out(const Matrix& from, Array& to) {
  std::copy(from.data(), from.data() + from.size(), to.begin());
}

msgs::GroupPrior prior_message(const PosePrior& prior) {
  msgs::GroupPrior message{.model = prior.model, .has_position = prior.position.has_value()};
  if (prior.position) {
    copy_out(prior.position->mean, message.position);
    copy_out(prior.position->covariance, message.position_covariance);
  }
  copy_out(prior.orientation.axes, message.axes);
  copy_out(prior.orientation.concentrations, message.concentrations);
  message.weight = prior.weight;
  return message;
}

PosePrior prior_from(const msgs::GroupPrior& message) {
  PosePrior prior;
  prior.model = message.model;
  prior.weight = message.weight;
  if (message.has_position) {
    prior.position.emplace();
    prior.position->mean = Eigen::Map<const Eigen::Vector3d>(message.position.data());
    prior.position->covariance =
        Eigen::Map<const Eigen::Matrix3d>(message.position_covariance.data());
  }
  prior.orientation.axes = Eigen::Map<const Eigen::Matrix<double, 4, 3>>(message.axes.data());
  prior.orientation.concentrations =
      Eigen::Map<const Eigen::Vector3d>(message.concentrations.data());
  return prior;
}

constexpr std::size_t kPoseNumbers = 7;
constexpr std::size_t kMaxCandidates = 1000;  // of a model

void put(const Pose& pose, double* to) {
  std::copy_n(pose.rotation.coeffs().data(), 4, to);  // x y z w
  std::copy_n(pose.translation.data(), 3, to + 4);
}

Pose pose_from(const double* numbers) {
  return {Eigen::Quaterniond(Eigen::Map<const Eigen::Vector4d>(numbers)),
          Eigen::Map<const Eigen::Vector3d>(numbers + 4)};
}

}  // namespace

msgs::GroupTask task_message(const Frame& frame, const DetectRequest& request,
                             const DetectorOptions& options, const SharedLibrary& library) {
  msgs::GroupTask task;
  task.library = library.offer.digest;
  task.frame = frame_message(frame);
  task.background = frame.background;
  task.fused_frames = static_cast<std::uint32_t>(frame.fused);
  task.options = option_texts(options);
  for (const PosePrior& prior : request.priors) task.priors.push_back(prior_message(prior));
  task.seed = request.seed;
  for (const ExpectedPlacement& expected : request.expected) {
    const auto model = library.models.find(expected.model);
    if (!model) continue;  // unloaded since
    task.expected_models.push_back(model->number);
    task.expected_poses.resize(task.expected_poses.size() + kPoseNumbers);
    put(expected.frame_from_object, &*task.expected_poses.end() - kPoseNumbers);
  }
  return task;
}

Result<DetectorOptions> options_from(const std::vector<std::string>& texts) {
  DetectorOptions options;
  const std::vector<Option> known = options_of(options);
  for (const std::string& text : texts) {
    if (Status status = io::set_option(text, {known, "-", {}}); !status.ok()) return status;
  }
  return options;
}

Result<Task> task_from(msgs::GroupTask message, const SharedLibrary& library) {
  Task task;
  for (const int number : message.models) {
    auto model = library.find(number);
    if (!model) return not_found("the library has no model of number ", number);
    if (std::ranges::count(task.models, model) > 0) {
      return corrupt("a task names model ", model->name, " twice");
    }
    task.request.models.push_back(model->name);
    task.models.push_back(std::move(model));
  }
  if (task.models.empty()) return corrupt("a task names no model");
  task.frame = frame_from(message);
  if (Status status = validate(task.frame); !status.ok()) return status;
  std::ranges::transform(message.priors, std::back_inserter(task.request.priors), prior_from);
  task.request.seed = message.seed;
  task.request.budget_ms = message.budget_ms;
  if (message.expected_poses.size() != message.expected_models.size() * kPoseNumbers) {
    return corrupt("a task expects ", message.expected_models.size(), " models in ",
                   message.expected_poses.size(), " numbers");
  }
  for (std::size_t i = 0; i < message.expected_models.size(); ++i) {
    const auto model = library.find(message.expected_models[i]);
    if (!model) continue;
    task.request.expected.push_back(
        {model->name, pose_from(message.expected_poses.data() + i * kPoseNumbers)});
  }
  if (Status status = validate(task.request); !status.ok()) return status;
  return task;
}

void put_result(const SearchResult& found, msgs::GroupAnswer& answer) {
  for (const detect::Candidate& candidate : found.candidates) {
    answer.candidates.push_back(to_message(candidate));
  }
  for (const MissedModel& missed : found.missed) answer.missed.push_back(missed.expected);
  answer.cut = found.cut;
  for (const auto& [name, count] : kEffortCounts) answer.effort.push_back(found.effort.*count);
  answer.preparation_ms = found.preparation_ms;
}

namespace {

bool is_amount(double number) { return std::isfinite(number) && number >= 0; }

}  // namespace

Result<SearchResult> result_from(msgs::GroupAnswer message, const Models& models,
                                 std::size_t pixels) {
  if (message.status.code != 0) return wire::to_status(message.status);
  if (message.missed.size() != models.size() || message.effort.size() != std::size(kEffortCounts) ||
      message.candidates.size() > kMaxCandidates * models.size()) {
    return corrupt("an answer has ", message.missed.size(), " models, ", message.effort.size(),
                   " counts and ", message.candidates.size(), " candidates");
  }
  if (!std::ranges::all_of(message.missed, is_amount) ||
      !std::ranges::all_of(message.effort, is_amount) || !is_amount(message.preparation_ms) ||
      !is_amount(message.busy_ms)) {
    return corrupt("an answer has times or counts that are negative or not finite");
  }
  SearchResult found{.cut = message.cut, .preparation_ms = message.preparation_ms};
  for (std::size_t i = 0; i < models.size(); ++i) {
    found.missed.push_back({models[i]->name, message.missed[i]});
  }
  std::size_t next = 0;
  for (const auto& [name, count] : kEffortCounts) found.effort.*count = message.effort[next++];
  for (msgs::GroupCandidate& candidate : message.candidates) {
    const auto model = std::ranges::find(models, candidate.model, &ObjectModel::number);
    if (model == models.end()) {
      return corrupt("an answer has a candidate of model ", candidate.model,
                     ", which is not in its task");
    }
    Result<detect::Candidate> read = candidate_from(std::move(candidate), **model, pixels);
    if (!read.ok()) return read.status();
    found.candidates.push_back(std::move(read).value());
  }
  return found;
}

msgs::GroupCandidate to_message(const detect::Candidate& candidate) {
  msgs::GroupCandidate message;
  message.model = candidate.model->number;
  put(candidate.pose(), message.pose.data());
  copy_out(candidate.refinement.information, message.information);
  message.correspondences = candidate.refinement.num_correspondences;
  message.found_by = static_cast<std::uint8_t>(candidate.found_by);
  message.values.assign(candidate.values.begin(), candidate.values.end());
  message.prior = candidate.prior;
  message.score = candidate.score;
  message.probability = candidate.probability;
  message.explained = candidate.explained;
  return message;
}

Result<detect::Candidate> candidate_from(msgs::GroupCandidate message, const ObjectModel& model,
                                         std::size_t pixels) {
  detect::Candidate candidate{.model = &model};
  const bool in_image = message.explained.empty() || message.explained.back() < pixels;
  const bool increases =
      std::ranges::is_sorted(message.explained, std::less_equal<std::uint32_t>());
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (message.values.size() != candidate.values.size() || !in_image || !increases ||
      !std::ranges::all_of(message.information, is_finite) || !is_finite(message.prior) ||
      !is_finite(message.score) || !(message.probability >= 0 && message.probability <= 1)) {
    return corrupt("a candidate of ", model.name, " has ", message.values.size(),
                   " score components, not ", candidate.values.size(),
                   ", numbers that are not finite, or pixels outside of the image");
  }
  if (message.found_by >= static_cast<std::uint8_t>(detect::Source::count)) {
    return corrupt("a candidate of ", model.name, " has found_by ", int{message.found_by});
  }
  candidate.refinement.frame_from_object = pose_from(message.pose.data());
  if (!is_valid(candidate.pose())) return corrupt("a candidate of ", model.name, " has no pose");
  candidate.refinement.information =
      Eigen::Map<const Eigen::Matrix<double, 6, 6>>(message.information.data());
  candidate.refinement.num_correspondences = message.correspondences;
  candidate.found_by = static_cast<detect::Source>(message.found_by);
  std::ranges::copy(message.values, candidate.values.begin());
  candidate.prior = message.prior;
  candidate.score = message.score;
  candidate.probability = message.probability;
  candidate.explained = std::move(message.explained);
  return candidate;
}

}  // namespace bpa::server::group
