// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A robot on Eclipse Cyclone DDS, made from idl/dds.idl alone: publishes a camera's topics as a ROS 2
// driver does (best effort, 20 Hz), listens to detections and interpretations, and asks the detect
// service twice a second as rmw_cyclonedds does. Usage: cyclone_robot DOMAIN NAMESPACE SECONDS.
// Says what comes: "detections MS STAMP FRAME CLASS PROBABILITY", "interpretations MS STAMP COUNT Z",
// "asked NUMBER", "answered NUMBER SUCCESS COUNT"; at the end "sees COUNT topics", endpoints of others.
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "dds/dds.h"
#include "framed.h"

typedef sensor_msgs_msg_dds__Image_ Image;
typedef sensor_msgs_msg_dds__CameraInfo_ CameraInfo;
typedef vision_msgs_msg_dds__Detection3DArray_ Detections;
typedef bpa_msgs_msg_dds__SceneInterpretations_ Interpretations;
typedef bpa_msgs_srv_dds__Detect_Request_ Request;
typedef bpa_msgs_srv_dds__Detect_Response_ Response;

enum { kWidth = 64, kHeight = 48, kPeriodMs = 50, kAskEvery = 10 };
static const uint64_t kClient = 0x0102030405060708u;
static char frame_id[] = "robot_camera";
static char empty[] = "";

static dds_entity_t participant;
static const char* ros_namespace;

static dds_entity_t check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "cyclone_robot: %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static int64_t now_ms(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (int64_t)t.tv_sec * 1000 + t.tv_nsec / 1000000;
}

static void say(const char* format, ...) {
  va_list list;
  va_start(list, format);
  vprintf(format, list);
  va_end(list);
  fflush(stdout);
}

static dds_entity_t topic(const dds_topic_descriptor_t* type, const char* prefix, const char* name) {
  char full[128];
  snprintf(full, sizeof(full), "%s%s/%s", prefix, ros_namespace, name);
  return check(dds_create_topic(participant, type, full, NULL, NULL), full);
}

static dds_qos_t* qos_of(dds_reliability_kind_t reliability) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, reliability, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  return qos;
}

static dds_entity_t writer_of(dds_entity_t of, dds_reliability_kind_t reliability) {
  dds_qos_t* qos = qos_of(reliability);
  const dds_entity_t writer = check(dds_create_writer(participant, of, qos, NULL), "writer");
  dds_delete_qos(qos);
  return writer;
}

static dds_entity_t reader_of(dds_entity_t of) {
  dds_qos_t* qos = qos_of(DDS_RELIABILITY_RELIABLE);
  const dds_entity_t reader = check(dds_create_reader(participant, of, qos, NULL), "reader");
  dds_delete_qos(qos);
  return reader;
}

static uint8_t color_pixels[3 * kWidth * kHeight];
static uint16_t depth_pixels[kWidth * kHeight];

static Image image_of(int32_t number, char* encoding, int pixel_bytes, void* pixels) {
  Image image;
  memset(&image, 0, sizeof(image));
  image.header.stamp.sec = number;
  image.header.frame_id = frame_id;
  image.width = kWidth;
  image.height = kHeight;
  image.encoding = encoding;
  image.step = (uint32_t)(kWidth * pixel_bytes);
  image.data._buffer = pixels;
  image.data._length = image.data._maximum = image.step * kHeight;
  return image;
}

static void publish(int32_t number, dds_entity_t color, dds_entity_t depth, dds_entity_t info) {
  static char rgb8[] = "rgb8", mm[] = "16UC1", model[] = "plumb_bob";
  CameraInfo camera;
  memset(&camera, 0, sizeof(camera));
  camera.header.stamp.sec = number;
  camera.header.frame_id = frame_id;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.distortion_model = model;
  camera.k[0] = camera.k[4] = 60;
  camera.k[2] = 31.5;
  camera.k[5] = 23.5;
  camera.k[8] = 1;
  const Image color_image = image_of(number, rgb8, 3, color_pixels);
  const Image depth_image = image_of(number, mm, 2, depth_pixels);
  dds_write(info, &camera);
  dds_write(color, &color_image);
  dds_write(depth, &depth_image);
}

static void ask(dds_entity_t requests, int64_t number) {
  Request request;
  memset(&request, 0, sizeof(request));
  request.client_id = kClient;
  request.request_number = number;
  request.frame.header.frame_id = empty;
  request.frame.color_encoding = empty;
  request.frame.depth_encoding = empty;
  request.timeout_ms = 3000;
  if (dds_write(requests, &request) == 0) say("asked %d\n", (int)number);
}

static void hear_detections(const void* sample) {
  const Detections* m = sample;
  const int any = m->detections._length > 0 && m->detections._buffer[0].results._length > 0;
  say("detections %lld %d %s %s %.4f\n", (long long)now_ms(), m->header.stamp.sec,
      m->header.frame_id, any ? m->detections._buffer[0].results._buffer[0].hypothesis.class_id : "-",
      any ? m->detections._buffer[0].results._buffer[0].hypothesis.score : 0.0);
}

static void hear_interpretations(const void* sample) {
  const Interpretations* m = sample;
  const int any = m->interpretations._length > 0 && m->interpretations._buffer[0].placements._length > 0;
  say("interpretations %lld %d %u %.4f\n", (long long)now_ms(), m->header.stamp.sec,
      m->interpretations._length,
      any ? m->interpretations._buffer[0].placements._buffer[0].pose.pose.position.z : 0.0);
}

static void hear_reply(const void* sample) {
  const Response* m = sample;
  if (m->client_id != kClient) return;
  say("answered %d %d %u\n", (int)m->request_number, m->success, m->result.interpretations._length);
}

static void take_all(dds_entity_t reader, void (*hear)(const void*)) {
  void* sample[1] = {NULL};
  dds_sample_info_t info[1];
  while (dds_take(reader, sample, info, 1, 1) > 0) {
    if (info[0].valid_data) hear(sample[0]);
    dds_return_loan(reader, sample, 1);
    sample[0] = NULL;
  }
}

/* Endpoints of other participants that are known now. */
static int count_others(dds_entity_t builtin_topic) {
  const dds_entity_t reader = check(dds_create_reader(participant, builtin_topic, NULL, NULL), "discovery");
  dds_guid_t own;
  dds_get_guid(participant, &own);
  void* sample[1] = {NULL};
  dds_sample_info_t info[1];
  int others = 0;
  while (dds_take(reader, sample, info, 1, 1) > 0) {
    const dds_builtintopic_endpoint_t* endpoint = sample[0];
    others += info[0].valid_data && memcmp(&endpoint->participant_key, &own, sizeof(own)) != 0;
    dds_return_loan(reader, sample, 1);
    sample[0] = NULL;
  }
  dds_delete(reader);
  return others;
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  participant = check(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  ros_namespace = argv[2];
  const int64_t end = now_ms() + 1000 * atoi(argv[3]);
  for (int i = 0; i < kWidth * kHeight; ++i) depth_pixels[i] = 900;

  const dds_topic_descriptor_t* image = &sensor_msgs_msg_dds__Image__desc;
  const dds_reliability_kind_t best_effort = DDS_RELIABILITY_BEST_EFFORT;
  const dds_entity_t color = writer_of(topic(image, "rt", "camera/color"), best_effort);
  const dds_entity_t depth = writer_of(topic(image, "rt", "camera/depth"), best_effort);
  const dds_entity_t info =
      writer_of(topic(&sensor_msgs_msg_dds__CameraInfo__desc, "rt", "camera/info"), best_effort);
  const dds_entity_t detections =
      reader_of(topic(&vision_msgs_msg_dds__Detection3DArray__desc, "rt", "detections"));
  const dds_entity_t interpretations =
      reader_of(topic(&bpa_msgs_msg_dds__SceneInterpretations__desc, "rt", "interpretations"));
  const dds_entity_t replies =
      reader_of(topic(&bpa_msgs_srv_dds__Detect_Response__desc, "rr", "detectReply"));
  const dds_entity_t requests = writer_of(
      topic(&bpa_msgs_srv_dds__Detect_Request__desc, "rq", "detectRequest"), DDS_RELIABILITY_RELIABLE);

  for (int32_t number = 1; now_ms() < end; ++number) {
    publish(number, color, depth, info);
    dds_publication_matched_status_t servers;
    dds_get_publication_matched_status(requests, &servers);
    if (number % kAskEvery == 0 && servers.current_count > 0) ask(requests, number / kAskEvery);
    for (const int64_t next = now_ms() + kPeriodMs; now_ms() < next; usleep(1000)) {
      take_all(detections, hear_detections);
      take_all(interpretations, hear_interpretations);
      take_all(replies, hear_reply);
    }
  }
  say("sees %d topics\n", count_others(DDS_BUILTIN_TOPIC_DCPSPUBLICATION) +
                              count_others(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION));
  dds_delete(participant);
  return 0;
}
