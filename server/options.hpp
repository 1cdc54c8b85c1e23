// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "camera/camera_options.hpp"
#include "core/base/options.hpp"
#include "core/base/status.hpp"
#include "core/pipeline/detector_options.hpp"
#include "core/result/interpretation.hpp"
#include "core/track/tracker.hpp"

// Every setting of the server, in groups. Each field describes itself once; reading server.yaml,
// --set, --print-config, the ROS 2 parameters and the checks all use that. config/server.yaml shows
// them all.

namespace bpa::server {

struct NodeOptions {
  std::string name = "server";
  std::string ros_namespace = "/bpa";
  std::vector<std::string> remaps;
  bool use_sim_time = false;

  void visit_fields(auto&& visit) {
    visit("name", name, {0, 0, "How ROS 2 tools show the server in its namespace."});
    visit("namespace", ros_namespace,
          {0, 0, "Goes in front of every name below that has no leading '/'."});
    visit("remaps", remaps, {0, 0, "Other names for topics and services: [from:=to]."});
    visit("use_sim_time", use_sim_time,
          at_run_time({0, 0,
                       "Take the time from /clock: stamps, time-outs of requests, silence of "
                       "cameras. The ROS 2 parameter has this name alone."}));
  }
};

struct NetworkOptions {
  int domain = -1;
  std::string range = "environment";
  std::vector<std::string> peers;
  int datagram_bytes = 8900;
  std::string graph_layout = "automatic";
  std::string profiles;

  void visit_fields(auto&& visit) {
    visit("domain", domain, {-1, 232, "DDS domain; -1 takes ROS_DOMAIN_ID, else 0."});
    visit("range", range,
          {0, 0,
           "How far to look for others: environment (as ROS_AUTOMATIC_DISCOVERY_RANGE and "
           "ROS_LOCALHOST_ONLY say), subnet, localhost, humble_localhost (as Humble's "
           "ROS_LOCALHOST_ONLY does it), off."});
    visit("peers", peers, {0, 0, "More hosts to discover: names or addresses."});
    visit("datagram_bytes", datagram_bytes,
          {1400, 65500,
           "Largest UDP datagram to send. Smaller ones lose less on a lossy network, where each "
           "packet of a datagram counts: 1472 is one packet of Ethernet. Larger ones cost less "
           "time."});
    visit("graph_layout", graph_layout,
          {0, 0,
           "Size of ids in the ROS 2 graph: humble (24 bytes), iron (16: Iron and later), "
           "automatic (iron unless all ROS 2 peers in sight are Humble's)."});
    visit("profiles", profiles,
          {0, 0,
           "File of Fast DDS XML profiles that override transports and timing, such as "
           "dds_profiles.xml; empty: none."});
  }
};

/// DDS Security.
struct SecurityOptions {
  std::string keystore;
  std::string enclave = "/bpa_server";

  void visit_fields(auto&& visit) {
    visit(
        "keystore", keystore,
        {0, 0,
         "Folder that --make-keystore or SROS 2 made: only peers of the same authority take part, "
         "encrypted. Empty: as ROS_SECURITY_ENABLE and its like say. Needs Fast DDS 3, as Debian "
         "13 has it."});
    visit("enclave", enclave, {0, 0, "Which identity and permissions of the keystore are ours."});
  }
};

struct InputOptions {
  std::string frames = "frames";
  bool frames_reliable = true;
  std::string color = "/camera/color/image_raw";
  std::string color_transport = "raw";
  std::string depth = "/camera/aligned_depth_to_color/image_raw";
  std::string depth_transport = "raw";
  std::string camera_info = "/camera/color/camera_info";
  std::string cloud;
  std::string tf = "/tf";
  std::string tf_static = "/tf_static";
  bool reliable = false;
  bool rectified = false;
  double sync_tolerance_ms = 10;
  int sync_queue = 10;
  double silence_s = 2;
  std::vector<std::string> views;
  double views_tolerance_ms = 50;
  std::string camera_poses;

  void visit_fields(auto&& visit) {
    visit("frames", frames, {0, 0, "Topic of bpa_msgs/RgbdFrame; empty: none."});
    visit("frames_reliable", frames_reliable,
          {0, 0, "Ask for reliable delivery; best-effort publishers then do not match."});
    visit("color", color, {0, 0, "Topic of colour images; empty: depth alone."});
    visit("color_transport", color_transport,
          {0, 0, "raw, or compressed: then TOPIC/compressed is taken."});
    visit("depth", depth, {0, 0, "Topic of depth images registered to colour; empty: no camera."});
    visit("depth_transport", depth_transport,
          {0, 0,
           "raw, or compressed (PNG) or compressedDepth: then TOPIC/compressed or "
           "TOPIC/compressedDepth is taken."});
    visit("camera_info", camera_info, {0, 0, "Topic of their sensor_msgs/CameraInfo."});
    visit("cloud", cloud,
          {0, 0, "Topic of organised sensor_msgs/PointCloud2 in an optical frame; empty: none."});
    visit("tf", tf,
          {0, 0, "Topic of transforms, subscribed to with tracking.fixed_frame; empty: none."});
    visit("tf_static", tf_static, {0, 0, "The same of static transforms."});
    visit("reliable", reliable,
          {0, 0, "Ask for reliable camera topics; best-effort cameras then do not match."});
    visit("rectified", rectified,
          at_run_time({0, 0,
                       "The camera's images have no lens distortion, so the projection matrix "
                       "p holds; false: k and d hold."}));
    visit("sync_tolerance_ms", sync_tolerance_ms,
          at_run_time({0, 1000,
                       "Largest difference in ms between the stamps of images of one frame; 0: "
                       "equal stamps only."}));
    visit("sync_queue", sync_queue, at_run_time({2, 100, "Images of one topic that may wait."}));
    visit("silence_s", silence_s,
          at_run_time(
              {0.1, 3600, "Seconds without a message after which a camera is reported as lost."}));
    visit("views", views,
          {0, 0,
           "Cameras of one scene, by the frame_ids of their frames, 2 to 16: frames of nearly one "
           "time are one search, with results in tracking.fixed_frame. Empty: each frame by "
           "itself."});
    visit("views_tolerance_ms", views_tolerance_ms,
          {0, 10000, "Largest difference in ms between the stamps of such frames."});
    visit("camera_poses", camera_poses,
          {0, 0,
           "File of `bpa calibrate` that says where cameras of several views are in "
           "tracking.fixed_frame, by the frame_ids of their frames; others are looked up in TF. "
           "Empty: all are."});
  }
};

/// A camera of the server's own: the device, and the topics on which its images go out.
struct CaptureOptions : camera::CameraOptions {
  std::string frame_id = "camera_color_optical_frame";
  bool search = true;
  std::string record_folder;
  double record_max_mb = 20000;
  std::string color_topic = "/camera/color/image_raw";
  std::string color_info_topic = "/camera/color/camera_info";
  std::string depth_topic = "/camera/aligned_depth_to_color/image_raw";
  std::string depth_info_topic = "/camera/aligned_depth_to_color/camera_info";
  std::string points_topic = "/camera/depth/color/points";

  void visit_fields(auto&& visit) {
    CameraOptions::visit_fields(visit);
    visit("frame_id", frame_id, {0, 0, "Frame id of this camera's messages."});
    visit("search", search, {0, 0, "Search its frames; false: only publish them."});
    visit("record_folder", record_folder,
          {0, 0,
           "Folder below which clients may have the sensor recorded; empty: nowhere. Links in "
           "it are not followed."});
    visit("record_max_mb", record_max_mb,
          {1, 1e9,
           "MB that the recordings in record_folder may take together; a recording that "
           "reaches it ends. A second takes about 46 MB."});
    visit("color_topic", color_topic, {0, 0, "sensor_msgs/Image, rgb8; empty: none."});
    visit("color_info_topic", color_info_topic,
          {0, 0, "sensor_msgs/CameraInfo beside it; empty: none."});
    visit("depth_topic", depth_topic,
          {0, 0, "sensor_msgs/Image, 16UC1 in mm, registered to colour; empty: none."});
    visit("depth_info_topic", depth_info_topic,
          {0, 0, "sensor_msgs/CameraInfo beside it; empty: none."});
    visit("points_topic", points_topic,
          {0, 0,
           "sensor_msgs/PointCloud2, xyz and rgb, made only while it has a subscriber; empty: "
           "none."});
  }
};

struct QueueOptions {
  int frames = 1;
  int requests = 8;

  void visit_fields(auto&& visit) {
    visit("frames", frames,
          at_run_time(
              {1, 100, "Frames of each camera that may wait; a newer one displaces the oldest."}));
    visit("requests", requests,
          at_run_time({1, 1000, "Detect requests that may wait; more are refused as busy."}));
  }
};

struct OutputOptions {
  std::string interpretations = "interpretations";
  std::string detections = "detections";
  std::string annotated = "annotated";
  std::string markers = "markers";
  std::string vision_info = "vision_info";
  std::string tf = "/tf";
  std::string tracks = "tracks";
  std::string track_states = "track_states";
  std::string track_markers = "track_markers";
  std::string diagnostics = "/diagnostics";
  std::string rosout = "/rosout";
  double marker_lifetime_s = 0;

  void visit_fields(auto&& visit) {
    visit("interpretations", interpretations,
          {0, 0, "bpa_msgs/SceneInterpretations: everything, ranked."});
    visit("detections", detections,
          {0, 0, "vision_msgs/Detection3DArray: the best interpretation."});
    visit("annotated", annotated,
          {0, 0, "sensor_msgs/Image, drawn only while it has a subscriber."});
    visit("markers", markers, {0, 0, "visualization_msgs/MarkerArray for RViz."});
    visit("vision_info", vision_info, {0, 0, "vision_msgs/VisionInfo, latched."});
    visit("tf", tf, {0, 0, "tf2_msgs/TFMessage: a transform per object; empty: none."});
    visit("tracks", tracks,
          {0, 0, "vision_msgs/Detection3DArray: confirmed and occluded tracks, id the track's."});
    visit("track_states", track_states, {0, 0, "bpa_msgs/Tracks: all tracks, everything."});
    visit("track_markers", track_markers,
          {0, 0, "visualization_msgs/MarkerArray of the tracks for RViz."});
    visit("diagnostics", diagnostics,
          {0, 0, "diagnostic_msgs/DiagnosticArray, once a second; empty: none."});
    visit("rosout", rosout,
          {0, 0, "rcl_interfaces/Log: what is said on the terminal; empty: none."});
    visit(
        "marker_lifetime_s", marker_lifetime_s,
        at_run_time(
            {0, 3600, "Seconds after which RViz removes markers; 0: when the next frame's come."}));
  }
};

struct DetectionOptions {
  std::string library;
  std::string model_folder;
  int max_models = 500;
  std::string detector;
  bool continuous = true;
  int top_k = kDefaultTopK;
  double budget_ms = 0;
  int fuse_frames = 1;
  bool follow = true;
  std::uint64_t seed = 0;
  int threads = 0;
  double request_timeout_ms = 30000;
  double hang_s = 600;

  void visit_fields(auto&& visit) {
    visit("library", library, {0, 0, "Folder of the model library."});
    visit("model_folder", model_folder,
          {0, 0,
           "Folder below which clients may name models by path; empty: they name those of the "
           "library alone. Links in it are not followed."});
    visit("max_models", max_models,
          {1, 10000, "Models that clients may load, those of the library included."});
    visit("detector", detector,
          {0, 0, "File with settings of the detector (detector.yaml); empty: defaults."});
    visit("continuous", continuous,
          at_run_time({0, 0, "Search every frame; false: only when a request asks for one."}));
    visit("top_k", top_k, at_run_time({1, 100, "Interpretations to report."}));
    visit("budget_ms", budget_ms,
          at_run_time({0, 1e6, "Report the best so far after this many ms; 0: no limit."}));
    visit("fuse_frames", fuse_frames,
          at_run_time({1, 30,
                       "Latest frames that are combined before the search, for a static camera "
                       "and scene; 1: each frame by itself."}));
    visit("follow", follow,
          at_run_time({0, 0,
                       "Look first for what the camera's frame before showed; false: search each "
                       "frame as if it were the first."}));
    visit(
        "seed", seed,
        at_run_time({0, 9.0e15,
                     "Same frame, library and seed: same answer. With follow, frames before count "
                     "too."}));
    visit("threads", threads,
          at_run_time({0, 256, "0: one per core. Does not change the answer."}));
    visit("request_timeout_ms", request_timeout_ms,
          at_run_time({1, 1e7, "Longest wait of a detect request that names none, milliseconds."}));
    visit("hang_s", hang_s,
          at_run_time({0, 86400,
                       "Seconds after which a search that has not returned hangs: the server says "
                       "so and ends with exit code 3, for systemd to start it anew; 0: never."}));
  }
};

/// Of the tracker, and of what the server does around it.
struct TrackingOptions : track::TrackerOptions {
  bool enabled = true;
  std::string fixed_frame;
  double tf_wait_ms = 100;
  double tf_buffer_s = 10;
  bool publish_tf = false;
  int queue_frames = 1;
  double linger_s = 10;
  int search_nice = 10;
  double rest_s = 10;

  void visit_fields(auto&& visit) {
    visit("enabled", enabled,
          at_run_time({0, 0,
                       "Follow objects from frame to frame while a topic of tracks has a "
                       "subscriber; without one it costs nothing. false: never."}));
    visit("fixed_frame", fixed_frame,
          {0, 0,
           "Frame of /tf that stands still, such as map or base_link, for a moving camera: tracks "
           "are in it. Empty: in the camera's frame, for a camera that stands still."});
    visit("tf_wait_ms", tf_wait_ms,
          at_run_time({0, 1000,
                       "Longest wait in ms for the camera's transform at a frame's stamp. A frame "
                       "without one is not followed."}));
    visit("tf_buffer_s", tf_buffer_s,
          at_run_time({0.1, 60, "Seconds of transforms that are remembered, by their stamps."}));
    visit("publish_tf", publish_tf,
          at_run_time({0, 0,
                       "Send a transform for each confirmed or occluded track to output.tf; the "
                       "child frame is the track's name."}));
    visit("queue_frames", queue_frames,
          at_run_time({1, 30,
                       "Frames that may wait to be followed; a newer one displaces the oldest. "
                       "More where transforms come late."}));
    visit("linger_s", linger_s,
          at_run_time({0, 3600,
                       "Seconds that objects are followed on after the last subscriber left, so "
                       "that one that restarts finds the same tracks."}));
    visit("search_nice", search_nice,
          at_run_time({0, 19,
                       "Added to the nice value of the search's threads while objects are "
                       "followed: it leaves the processor to tracking. Only root may lower it "
                       "again."}));
    visit("rest_s", rest_s,
          at_run_time({0, 3600,
                       "Seconds between searches of a scene that stands still, while nobody "
                       "subscribes to results of searches; 0: every frame is searched."}));
    TrackerOptions::visit_fields([&](const char* name, auto& value, const FieldRule& rule) {
      visit(name, value, at_run_time(rule));
    });
  }
};

/// A page for browsers.
struct WebOptions {
  std::string listen;
  std::string token_file;
  std::vector<std::string> hosts;
  int history = 20;
  double rate_hz = 10;

  void visit_fields(auto&& visit) {
    visit("listen", listen,
          {0, 0,
           "[ADDRESS:]PORT on which browsers find the page; a port alone: this machine only. "
           "Empty: no page."});
    visit("token_file", token_file,
          {0, 0,
           "File of mode 0600 whose first line is the token that browsers need. Empty: on an "
           "address that other machines reach, one is made and printed at the start."});
    visit("hosts", hosts,
          {0, 0, "More names of this machine that browsers may use, such as robot.local."});
    visit("history", history,
          {1, 200,
           "Results that viewers of the page may go back to; one that is held is kept besides."});
    visit("rate_hz", rate_hz,
          at_run_time({0.1, 60, "Most frames a second that a viewer of the page is told of."}));
  }
};

/// Many hosts that search one library.
struct GroupOptions {
  std::string role = "single";
  std::string name = "bpa";
  int strength = 0;
  std::string cache;

  void visit_fields(auto&& visit) {
    visit("role", role,
          {0, 0,
           "single: search in this process. front: clients talk to it, the group's workers search. "
           "worker: search for the group's front.",
           false, "single front worker "});
    visit("name", name, {0, 0, "Fronts and workers of one name are a group."});
    visit("strength", strength,
          {-1000000, 1000000,
           "Of several fronts of a group the strongest serves; another takes over when it is "
           "gone."});
    visit("cache", cache,
          {0, 0,
           "Folder where a worker keeps the models that it has fetched. Empty: bpa/models below "
           "XDG_CACHE_HOME or ~/.cache."});
  }
};

struct LogOptions {
  std::string level = "info";

  void visit_fields(auto&& visit) {
    visit("level", level, at_run_time({0, 0, "debug, info, warning or error."}));
  }
};

struct ServerOptions {
  NodeOptions node;
  NetworkOptions network;
  SecurityOptions security;
  InputOptions input;
  CaptureOptions capture;
  QueueOptions queue;
  OutputOptions output;
  DetectionOptions detection;
  TrackingOptions tracking;
  WebOptions web;
  GroupOptions group;
  LogOptions log;
  /// How objects are found; config/detector.yaml shows them all.
  DetectorOptions detector;

  void visit_groups(auto&& visit) {
    visit("node", node, "Names.");
    visit("network", network, "Discovery and transport.");
    visit("security", security, "Who may take part.");
    visit("input", input, "Where frames come from.");
    visit("capture", capture, "A camera of the server's own.");
    visit("queue", queue, "What may wait while a frame is searched.");
    visit("output", output, "Topics of the results; an empty name switches one off.");
    visit("detection", detection, "The search.");
    visit("tracking", tracking, "Following objects from frame to frame.");
    visit("web", web, "A page for browsers.");
    visit("group", group, "Many hosts that search one library.");
    visit("log", log, "What is said on the terminal.");
    visit("detector", detector, "How objects are found. All of it also at run time.");
  }
};

/// Checks every field; the message names group.field, its value and the rule.
Status validate(const ServerOptions& options);

/// Overrides the fields that a YAML file names; see io::read_options(). A field of the detector may
/// be named without its group: detector.max_range_m. Fails with not_found, or with invalid_argument
/// naming file, line, key and rule; unknown keys are errors.
Status load_options(const std::string& path, ServerOptions& options);

/// Sets one field from text such as "queue.requests=4".
Status set_option(const std::string& assignment, ServerOptions& options);

/// All fields as a YAML file with a comment each, such as config/server.yaml; the detector's, which
/// have a file of their own, only if asked for.
std::string to_yaml(const ServerOptions& options, bool with_detector = false);

}  // namespace bpa::server
