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
#include "ros/synchronizer.hpp"

// Every setting of the server, in groups. config/server.yaml, --set, --print-config, the ROS 2
// parameters and the checks all use this.

namespace bpa::server {

struct NodeOptions {
  BPA_OPTION(std::string, name, "server", (), "How ROS 2 tools show the server in its namespace.");
  BPA_NAMED_OPTION("namespace", std::string, ros_namespace, "/bpa", (),
                   "Goes in front of every name below that has no leading '/'.");
  BPA_OPTION(std::vector<std::string>, remaps, {}, (),
             "Other names for topics and services: [from:=to].");
  BPA_OPTION(bool, use_sim_time, false, ().at_run_time(),
             "Take the time from /clock: stamps, time-outs of requests, silence of cameras. The "
             "ROS 2 parameter has this name alone.");
};

struct NetworkOptions {
  BPA_OPTION(int, domain, -1, (-1, 232), "DDS domain; -1 takes ROS_DOMAIN_ID, else 0.");
  BPA_OPTION(std::string, range, "environment", (),
             "How far to look for others: environment (as ROS_AUTOMATIC_DISCOVERY_RANGE and "
             "ROS_LOCALHOST_ONLY say), subnet, localhost, humble_localhost (as Humble's "
             "ROS_LOCALHOST_ONLY does it), off.");
  BPA_OPTION(std::vector<std::string>, peers, {}, (),
             "More hosts to discover: names or addresses.");
  BPA_OPTION(
      int, datagram_bytes, 8900, (1400, 65500),
      "Largest UDP datagram to send. Smaller ones lose less on a lossy network, where each packet "
      "of a datagram counts: 1472 is one packet of Ethernet. Larger ones cost less time.");
  BPA_OPTION(std::string, graph_layout, "automatic", (),
             "Size of ids in the ROS 2 graph: humble (24 bytes), iron (16: Iron and later), "
             "automatic (iron unless all ROS 2 peers in sight are Humble's).");
  BPA_OPTION(std::string, profiles, "", (),
             "File of Fast DDS XML profiles that override transports and timing, such as "
             "dds_profiles.xml; empty: none.");
};

/// DDS Security.
struct SecurityOptions {
  BPA_OPTION(std::string, keystore, "", (),
             "Folder that --make-keystore or SROS 2 made: only peers of the same authority take "
             "part, encrypted. Empty: as ROS_SECURITY_ENABLE and its like say. Needs Fast DDS 3, "
             "as Debian 13 has it.");
  BPA_OPTION(std::string, enclave, "/bpa_server", (),
             "Which identity and permissions of the keystore are ours.");
};

struct InputOptions {
  BPA_OPTION(std::string, frames, "frames", (), "Topic of bpa_msgs/RgbdFrame; empty: none.");
  BPA_OPTION(bool, frames_reliable, true, (),
             "Ask for reliable delivery; best-effort publishers then do not match.");
  BPA_OPTION(std::string, color, "/camera/color/image_raw", (),
             "Topic of colour images; empty: depth alone.");
  BPA_OPTION(std::string, color_transport, "raw", (),
             "raw, or compressed: then TOPIC/compressed is taken.");
  BPA_OPTION(std::string, depth, "/camera/aligned_depth_to_color/image_raw", (),
             "Topic of depth images registered to colour; empty: no camera.");
  BPA_OPTION(std::string, depth_transport, "raw", (),
             "raw, or compressed (PNG) or compressedDepth: then TOPIC/compressed or "
             "TOPIC/compressedDepth is taken.");
  BPA_OPTION(std::string, camera_info, "/camera/color/camera_info", (),
             "Topic of their sensor_msgs/CameraInfo.");
  BPA_OPTION(std::string, cloud, "", (),
             "Topic of organised sensor_msgs/PointCloud2 in an optical frame; empty: none.");
  BPA_OPTION(double, cloud_unit_m, 0, (0, 1),
             "Metres of one unit of its points; 0: metres, or millimetres where the median depth "
             "is over 100.");
  BPA_OPTION(std::string, tf, "/tf", (),
             "Topic of transforms, subscribed to with tracking.fixed_frame; empty: none.");
  BPA_OPTION(std::string, tf_static, "/tf_static", (), "The same of static transforms.");
  BPA_OPTION(bool, reliable, false, (),
             "Ask for reliable camera topics; best-effort cameras then do not match.");
  BPA_OPTION(bool, rectified, false, ().at_run_time(),
             "The camera's images have no lens distortion, so the projection matrix p holds; "
             "false: k and d hold.");
  BPA_OPTION(
      double, sync_tolerance_ms, ros::kSyncTolerance_ms, (0, 1000).at_run_time(),
      "Largest difference in ms between the stamps of images of one frame; 0: equal stamps only.");
  BPA_OPTION(int, sync_queue, ros::kSyncQueue, (2, 100).at_run_time(),
             "Images of one topic that may wait.");
  BPA_OPTION(double, silence_s, 2, (0.1, 3600).at_run_time(),
             "Seconds without a message after which a camera is reported as lost.");
  BPA_OPTION(
      std::vector<std::string>, views, {}, (),
      "Cameras of one scene, by the frame_ids of their frames, 2 to 16: frames of nearly one time "
      "are one search, with results in tracking.fixed_frame. Empty: each frame by itself.");
  BPA_OPTION(double, views_tolerance_ms, 50, (0, 10000),
             "Largest difference in ms between the stamps of such frames.");
  BPA_OPTION(std::string, camera_poses, "", (),
             "File of `bpa calibrate` that says where cameras of several views are in "
             "tracking.fixed_frame, by the frame_ids of their frames; others are looked up in TF. "
             "Empty: all are.");
};

/// A camera of the server's own: the device, and the topics on which its images go out.
struct CaptureOptions : camera::CameraOptions {
  BPA_BASE_OPTIONS(CameraOptions);
  BPA_OPTION(std::string, frame_id, "camera_color_optical_frame", (),
             "Frame id of this camera's messages.");
  BPA_OPTION(bool, search, true, (), "Search its frames; false: only publish them.");
  BPA_OPTION(std::string, record_folder, "", (),
             "Folder below which clients may have the sensor recorded; empty: nowhere. Links in it "
             "are not followed.");
  BPA_OPTION(double, record_max_mb, 20000, (1, 1e9),
             "MB that the recordings in record_folder may take together; a recording that reaches "
             "it ends. A second takes about 46 MB.");
  BPA_OPTION(std::string, color_topic, "/camera/color/image_raw", (),
             "sensor_msgs/Image, rgb8; empty: none.");
  BPA_OPTION(std::string, color_info_topic, "/camera/color/camera_info", (),
             "sensor_msgs/CameraInfo beside it; empty: none.");
  BPA_OPTION(std::string, depth_topic, "/camera/aligned_depth_to_color/image_raw", (),
             "sensor_msgs/Image, 16UC1 in mm, registered to colour; empty: none.");
  BPA_OPTION(std::string, depth_info_topic, "/camera/aligned_depth_to_color/camera_info", (),
             "sensor_msgs/CameraInfo beside it; empty: none.");
  BPA_OPTION(
      std::string, points_topic, "/camera/depth/color/points", (),
      "sensor_msgs/PointCloud2, xyz and rgb, made only while it has a subscriber; empty: none.");
};

struct QueueOptions {
  BPA_OPTION(int, frames, 1, (1, 100).at_run_time(),
             "Frames of each camera that may wait; a newer one displaces the oldest.");
  BPA_OPTION(int, requests, 8, (1, 1000).at_run_time(),
             "Detect requests that may wait; more are refused as busy.");
};

struct OutputOptions {
  BPA_OPTION(std::string, interpretations, "interpretations", (),
             "bpa_msgs/SceneInterpretations: everything, ranked.");
  BPA_OPTION(std::string, detections, "detections", (),
             "vision_msgs/Detection3DArray: the best interpretation.");
  BPA_OPTION(std::string, annotated, "annotated", (),
             "sensor_msgs/Image, drawn only while it has a subscriber.");
  BPA_OPTION(std::string, markers, "markers", (), "visualization_msgs/MarkerArray for RViz.");
  BPA_OPTION(std::string, vision_info, "vision_info", (), "vision_msgs/VisionInfo, latched.");
  BPA_OPTION(std::string, tf, "/tf", (),
             "tf2_msgs/TFMessage: a transform per object; empty: none.");
  BPA_OPTION(std::string, tracks, "tracks", (),
             "vision_msgs/Detection3DArray: confirmed and occluded tracks, id the track's.");
  BPA_OPTION(std::string, track_states, "track_states", (),
             "bpa_msgs/Tracks: all tracks, everything.");
  BPA_OPTION(std::string, track_markers, "track_markers", (),
             "visualization_msgs/MarkerArray of the tracks for RViz.");
  BPA_OPTION(std::string, diagnostics, "/diagnostics", (),
             "diagnostic_msgs/DiagnosticArray, once a second; empty: none.");
  BPA_OPTION(std::string, rosout, "/rosout", (),
             "rcl_interfaces/Log: what is said on the terminal; empty: none.");
  BPA_OPTION(double, marker_lifetime_s, 0, (0, 3600).at_run_time(),
             "Seconds after which RViz removes markers; 0: when the next frame's come.");
};

struct DetectionOptions {
  BPA_OPTION(std::string, library, "", (), "Folder of the model library.");
  BPA_OPTION(std::string, model_folder, "", (),
             "Folder below which clients may name models by path; empty: they name those of the "
             "library alone. Links in it are not followed.");
  BPA_OPTION(int, max_models, 500, (1, 10000),
             "Models that clients may load, those of the library included.");
  BPA_OPTION(std::string, detector, "", (),
             "File with settings of the detector (detector.yaml); empty: defaults.");
  BPA_OPTION(bool, continuous, true, ().at_run_time(),
             "Search every frame; false: only when a request asks for one.");
  BPA_OPTION(int, top_k, kDefaultTopK, (1, 100).at_run_time(), "Interpretations to report.");
  BPA_OPTION(double, budget_ms, 0, (0, 1e6).at_run_time(),
             "Report the best so far after this many ms; 0: no limit.");
  BPA_OPTION(int, fuse_frames, 1, (1, 30).at_run_time(),
             "Latest frames that are combined before the search, for a static camera and scene; 1: "
             "each frame by itself.");
  BPA_OPTION(bool, follow, true, ().at_run_time(),
             "Look first for what the camera's frame before showed; false: search each frame as if "
             "it were the first.");
  BPA_OPTION(std::uint64_t, seed, 0, (0, 9.0e15).at_run_time(),
             "Same frame, library and seed: same answer. With follow, frames before count too.");
  BPA_OPTION(int, threads, 0, (0, 256).at_run_time(),
             "0: one per core. Does not change the answer.");
  BPA_OPTION(double, request_timeout_ms, 30000, (1, 1e7).at_run_time(),
             "Longest wait of a detect request that names none, milliseconds.");
  BPA_OPTION(double, hang_s, 600, (0, 86400).at_run_time(),
             "Seconds after which a search that has not returned hangs: the server says so and "
             "ends with exit code 3, for systemd to start it anew; 0: never.");
};

/// Of the tracker, and of what the server does around it.
struct TrackingOptions : track::TrackerOptions {
  BPA_OPTION(bool, enabled, true, ().at_run_time(),
             "Follow objects from frame to frame while a topic of tracks has a subscriber; without "
             "one it costs nothing. false: never.");
  BPA_OPTION(std::string, fixed_frame, "", (),
             "Frame of /tf that stands still, such as map or base_link, for a moving camera: "
             "tracks are in it. Empty: in the camera's frame, for a camera that stands still.");
  BPA_OPTION(double, tf_wait_ms, 100, (0, 1000).at_run_time(),
             "Longest wait in ms for the camera's transform at a frame's stamp. A frame without "
             "one is not followed.");
  BPA_OPTION(double, tf_buffer_s, 10, (0.1, 60).at_run_time(),
             "Seconds of transforms that are remembered, by their stamps.");
  BPA_OPTION(bool, publish_tf, false, ().at_run_time(),
             "Send a transform for each confirmed or occluded track to output.tf; the child frame "
             "is the track's name.");
  BPA_OPTION(int, queue_frames, 1, (1, 30).at_run_time(),
             "Frames that may wait to be followed; a newer one displaces the oldest. More where "
             "transforms come late.");
  BPA_OPTION(double, linger_s, 10, (0, 3600).at_run_time(),
             "Seconds that objects are followed on after the last subscriber left, so that one "
             "that restarts finds the same tracks.");
  BPA_OPTION(int, search_nice, 10, (0, 19).at_run_time(),
             "Added to the nice value of the search's threads while objects are followed: it "
             "leaves the processor to tracking. Only root may lower it again.");
  BPA_OPTION(double, rest_s, 10, (0, 3600).at_run_time(),
             "Seconds between searches of a scene that stands still, while nobody subscribes to "
             "results of searches; 0: every frame is searched.");
  BPA_BASE_OPTIONS(TrackerOptions);
};

/// A page for browsers.
struct WebOptions {
  BPA_OPTION(std::string, listen, "", (),
             "[ADDRESS:]PORT on which browsers find the page; a port alone: this machine only. "
             "Empty: no page.");
  BPA_OPTION(std::string, token_file, "", (),
             "File of mode 0600 whose first line is the token that browsers need. Empty: on an "
             "address that other machines reach, one is made and printed at the start.");
  BPA_OPTION(std::vector<std::string>, hosts, {}, (),
             "More names of this machine that browsers may use, such as robot.local.");
  BPA_OPTION(int, history, 20, (1, 200),
             "Results that viewers of the page may go back to; one that is held is kept besides.");
  BPA_OPTION(double, rate_hz, 10, (0.1, 60).at_run_time(),
             "Most frames a second that a viewer of the page is told of.");
};

/// Many hosts that search one library.
struct GroupOptions {
  BPA_OPTION(std::string, role, "single", ("single front worker "),
             "single: search in this process. front: clients talk to it, the group's workers "
             "search. worker: search for the group's front.");
  BPA_OPTION(std::string, name, "bpa", (), "Fronts and workers of one name are a group.");
  BPA_OPTION(
      int, strength, 0, (-1000000, 1000000),
      "Of several fronts of a group the strongest serves; another takes over when it is gone.");
  BPA_OPTION(std::string, cache, "", (),
             "Folder where a worker keeps the models that it has fetched. Empty: bpa/models below "
             "XDG_CACHE_HOME or ~/.cache.");
};

struct LogOptions {
  BPA_OPTION(std::string, level, "info", ().at_run_time(), "debug, info, warning or error.");
};

struct ServerOptions {
  BPA_GROUP(NodeOptions, node, "Names.");
  BPA_GROUP(NetworkOptions, network, "Discovery and transport.");
  BPA_GROUP(SecurityOptions, security, "Who may take part.");
  BPA_GROUP(InputOptions, input, "Where frames come from.");
  BPA_GROUP(CaptureOptions, capture, "A camera of the server's own.");
  BPA_GROUP(QueueOptions, queue, "What may wait while a frame is searched.");
  BPA_GROUP(OutputOptions, output, "Topics of the results; an empty name switches one off.");
  BPA_GROUP(DetectionOptions, detection, "The search.");
  BPA_GROUP(TrackingOptions, tracking, "Following objects from frame to frame.");
  BPA_GROUP(WebOptions, web, "A page for browsers.");
  BPA_GROUP(GroupOptions, group, "Many hosts that search one library.");
  BPA_GROUP(LogOptions, log, "What is said on the terminal.");
  BPA_GROUP(DetectorOptions, detector, "How objects are found. All of it also at run time.");
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
