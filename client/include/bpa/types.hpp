// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <bpa/status.hpp>

// What goes to the server and what comes back: plain structs, C++17, SI units.
//
// Camera frame means the optical frame of the camera that took the image: x right, y down, z
// forward, metres.

namespace bpa {

/// Where an object is: the transform from the object's frame to the camera frame.
struct ObjectPose {
  std::array<double, 3> position{};                         ///< x, y, z in metres.
  std::array<double, 4> orientation{{0.0, 0.0, 0.0, 1.0}};  ///< Unit quaternion x, y, z, w.
};

/// How sure an orientation is: a Bingham distribution, density proportional to
/// exp(sum_i concentrations[i] (axes[i] . q)^2) over unit quaternions q = (w, x, y, z).
struct OrientationSpread {
  std::array<std::array<double, 4>, 3> axes{};  ///< Orthonormal, each in the order w, x, y, z.
  std::array<double, 3> concentrations{};       ///< Not positive; all zero is uniform.
};

/// One named part of a detection's score.
struct ScorePart {
  std::string name;
  double value = 0;
};

/// Another pose that the view cannot tell from the reported one.
struct AlternativePose {
  ObjectPose camera_from_object;
  double weight = 0;  ///< In (0, 1].
};

/// One object found in one frame.
struct Detection {
  std::string model;     ///< A name that Client::models returns.
  int model_number = 0;  ///< The model's number in the server's library.
  int instance = 0;      ///< Counts the detections of this model in one interpretation, from 0.
  ObjectPose camera_from_object;
  /// Row-major 6x6 covariance of (x, y, z, rotation about x, y, z), m^2 and rad^2. The axes are
  /// those of the camera frame.
  std::array<double, 36> covariance{};
  OrientationSpread orientation_spread;
  double score = 0;        ///< Larger is better; comparable within one model only.
  double probability = 0;  ///< That it is within 2.5 cm and pi/16 of the truth, in [0, 1].
  double presence = 0;     ///< That the object is there, at this pose or an alternative, in [0, 1].
  double visible_fraction = 0;  ///< Of the surface that faces the camera, in [0, 1].
  std::vector<ScorePart> score_parts;
  std::vector<AlternativePose> alternatives;  ///< Empty when the view decides.
};

/// One way to explain the frame: detections that fit together.
struct RankedInterpretation {
  int rank = 1;  ///< 1 is the best.
  double score = 0;
  double probability = 0;             ///< Among the interpretations of one frame.
  std::vector<Detection> detections;  ///< Most probable first.
};

struct StageTime {
  std::string stage;
  double milliseconds = 0;
};

/// How many objects of a model the search expects to have missed.
struct MissedObjects {
  std::string model_name;
  double expected = 0;  ///< Objects in sight that are undiscovered; 0 or more.
};

/// What was found in one frame. An empty scene is an answer, not an error.
struct DetectionSet {
  std::int64_t stamp_ns = 0;  ///< Exposure time of the frame that was searched, UTC.
  std::string frame_id;       ///< Name of its camera frame.
  /// Why the frame could not be searched; ok when it was. Its message then says what keeps the
  /// server from finding more in such frames (wrong unit, colour that is not registered), or which
  /// models were not searched for, as a worker of the server's group was lost.
  Status status;
  std::vector<RankedInterpretation> interpretations;  ///< Best first.
  std::vector<StageTime> stage_times;                 ///< In the order in which the stages ran.
  double total_ms = 0;
  bool budget_exhausted = false;  ///< The time budget ended the search: the best found so far.
  /// How many frames of the stream the depth that was searched is made of (the server's setting
  /// detection.fuse_frames); 1: of this one alone.
  int fused_frames = 1;
  int models_searched = 0;
  /// Of each model that was searched for; empty from several views. With a small sum, what is not
  /// reported was searched for and not found.
  std::vector<MissedObjects> missed;
  std::uint64_t seed = 0;  ///< Gives the same answer again for the same frame and options.
  /// How many frames and requests waited before this one when the server accepted it; 0 for frames
  /// of the stream.
  int queue_position = 0;

  /// The detections of the best interpretation; none when there is no interpretation.
  const std::vector<Detection>& best() const {
    static const std::vector<Detection> none;
    return interpretations.empty() ? none : interpretations.front().detections;
  }
};

/// One RGB-D image that stays the caller's: nothing is copied before it is sent. Depth is
/// registered to colour; rows run from top to bottom without padding.
struct FrameView {
  int width = 0;  ///< Pixels, 16 to 8192.
  int height = 0;
  const std::uint8_t* rgb = nullptr;        ///< 3 bytes a pixel; nullptr without colour.
  const std::uint16_t* depth_mm = nullptr;  ///< Millimetres along z, 0 = none. This one ...
  const float* depth_m = nullptr;           ///< ... or metres along z, 0 or NaN = none.
  double fx = 0;                            ///< Focal lengths and principal point, pixels; the
  double fy = 0;                            ///< centre of the top left pixel is (0, 0).
  double cx = 0;
  double cy = 0;
  std::int64_t stamp_ns = 0;  ///< Exposure time, UTC.
  std::string frame_id = "camera";
  const std::uint8_t* mask =
      nullptr;               ///< One byte a pixel, 0 = do not search; nullptr: search all.
  std::array<int, 4> roi{};  ///< x, y, width, height; all zero: the whole image.
};

/// What you know beforehand of where an object is, in the camera frame: from tracking, from touch,
/// from where a robot put it down. The server samples poses there too and weighs them by the prior.
struct ExpectedPose {
  std::string model;
  /// The most probable pose. Its orientation is ignored where orientation_spread is uniform, its
  /// position where position_covariance is zero.
  ObjectPose camera_from_object;
  std::array<double, 9> position_covariance{};  ///< m^2, row by row; all zero: position unknown.
  OrientationSpread orientation_spread;         ///< As Detection has it; uniform: unknown.
  double weight = 0.95;                         ///< Probability that this prior applies, in (0, 1].
};

/// The spread of an orientation (x, y, z, w) with standard deviation `sigma_rad` about each axis.
OrientationSpread spread_about(const std::array<double, 4>& orientation, double sigma_rad);
/// A prior about a pose with the same standard deviations along and about each axis; metres,
/// radians, each above 0.
ExpectedPose expected_pose(const std::string& model, const ObjectPose& camera_from_object,
                           double position_sigma_m, double sigma_rad, double weight = 0.95);

/// What to look for. Zero and empty fields leave the choice to the server.
struct DetectQuery {
  std::vector<std::string> models;  ///< Names; empty means every model of the library.
  int top_k = 0;                    ///< Number of interpretations wanted, at most 100.
  double budget_ms = 0;             ///< Time for the search; the best so far is returned.
  std::uint64_t seed = 0;
  std::vector<ExpectedPose> priors = {};  ///< What is known beforehand of the frame.
};

/// A frame of one of several cameras of a scene that stands still, or of one camera that moved.
struct PosedFrame {
  FrameView frame;
  /// Of the camera's optical frame, in the fixed frame; metres.
  ObjectPose scene_from_camera;
};

/// What several frames of one scene show together.
struct SceneDetections {
  DetectionSet found;  ///< In the fixed frame: camera_from_object is scene_from_object.
  /// Poses of the cameras as used: moved until their surfaces agree, unless the server's setting
  /// detector.views.align_cameras is off.
  std::vector<ObjectPose> scene_from_camera;
  /// A sentence for each two cameras whose surfaces disagree, with the distance and the angle.
  std::vector<std::string> warnings;
};

/// What is known of a tracked object now.
enum class TrackedState {
  tentative,  ///< Found once; the next frames and searches decide.
  confirmed,  ///< Followed in this frame.
  occluded,   ///< Hidden by nearer surface or outside of the image; its pose is predicted.
  lost,       ///< Not where it was expected, nor hidden; waits for a search to find it again.
};

/// "tentative", "confirmed", "occluded" or "lost".
const char* to_string(TrackedState state);

/// Another pose of a tracked object that the views so far explain as well.
struct TrackedAlternative {
  ObjectPose frame_from_object;
  double weight = 0;  ///< In (0, 1].
};

/// One object, followed from frame to frame. Poses, velocities and covariances are about the axes
/// of TrackSet::frame_id.
struct TrackedObject {
  std::uint64_t id = 0;  ///< From 1; never used for another object in a run of the server.
  std::string name;      ///< Unique among the tracks; "MODEL_N" unless it was renamed.
  std::string model;     ///< A name that Client::models returns.
  int model_number = 0;  ///< The model's number in the server's library.
  TrackedState state = TrackedState::tentative;
  double probability = 0;  ///< That the object is there, in [0, 1].
  ObjectPose frame_from_object;
  /// Row-major 6x6 covariance of (x, y, z, rotation about x, y, z), m^2 and rad^2.
  std::array<double, 36> covariance{};
  OrientationSpread orientation_spread;
  std::array<double, 3> velocity{};          ///< Of the model's origin, m/s.
  std::array<double, 3> angular_velocity{};  ///< rad/s.
  double visible_fraction = 0;  ///< Of the surface that faces the camera, in this frame, in [0, 1].
  double age_s = 0;             ///< Since its first frame.
  double unseen_s = 0;          ///< Since it was last seen.
  bool held = false;            ///< Does not end for being unseen: see Client::hold_track.
  double weight = 1;            ///< Of the pose against its alternatives, in (0, 1].
  std::vector<TrackedAlternative> alternatives;  ///< By falling weight; empty: there is none.
};

/// A track that has ended.
struct EndedObject {
  std::uint64_t id = 0;
  std::string name;
  std::string reason;  ///< For people.
};

/// All tracks after one frame.
struct TrackSet {
  std::int64_t stamp_ns = 0;  ///< Exposure time of the frame, UTC.
  std::string frame_id;  ///< Of the poses: the server's tracking.fixed_frame, or the camera frame.
  std::string camera_frame_id;
  bool in_fixed_frame = false;        ///< Whether the camera's motion is known, from /tf.
  ObjectPose frame_from_camera;       ///< The identity without a fixed frame.
  std::vector<TrackedObject> tracks;  ///< By id; tentative, occluded and lost ones too.
  std::vector<EndedObject> ended;     ///< In this frame.
  double total_ms = 0;                ///< That following took.
};

/// One model of the server's library.
struct KnownModel {
  std::string name;
  int number = 0;
  double diameter = 0;              ///< Metres.
  std::array<double, 3> box_min{};  ///< Corners of the box along the model's axes, metres.
  std::array<double, 3> box_max{};
  int point_count = 0;
  int discrete_symmetries = 0;  ///< How many, without the identity.
  int continuous_symmetries = 0;
};

/// How the server is doing. Counters start at zero when it starts.
struct ServerStatus {
  std::string version;
  std::string state;  ///< "idle", "running" or "paused".
  double uptime_s = 0;
  std::uint64_t frames_received = 0;
  std::uint64_t frames_processed = 0;
  std::uint64_t frames_dropped = 0;   ///< A newer frame took the place.
  std::uint64_t frames_rejected = 0;  ///< Broke a rule; the server's log says which.
  std::uint64_t requests_served = 0;
  std::uint64_t requests_refused = 0;
  int queue_length = 0;
  int queue_capacity = 0;
  int model_count = 0;
  std::string library;  ///< Where it lies on the server.
  std::uint64_t memory_bytes = 0;
  std::vector<StageTime> stage_times;                        ///< Medians over the last frames.
  std::vector<std::pair<std::string, std::string>> details;  ///< Such as drops by cause.
};

/// A recording of the server's camera.
struct Recording {
  std::string path;         ///< On the server's machine.
  int frames = 0;           ///< Once it has ended.
  std::uint64_t bytes = 0;  ///< Once it has ended.
};

/// The server's drawing of what it found.
struct AnnotatedImage {
  std::int64_t stamp_ns = 0;
  std::string frame_id;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;  ///< Row-major, 3 bytes a pixel.
};

}  // namespace bpa
