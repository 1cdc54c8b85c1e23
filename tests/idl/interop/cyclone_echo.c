// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A peer on Eclipse Cyclone DDS, made from idl/dds.idl alone: sends back on rt/out/X what comes on
// rt/in/X. Usage: cyclone_echo DOMAIN [xcdr2, for that encoding alone]; ends when its standard input does, or after two minutes.
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "dds.h"
#include "dds/dds.h"

typedef struct {
  const char* name;
  const dds_topic_descriptor_t* type;
  dds_entity_t reader, writer;
} Echo;

static Echo echoes[] = {
    {"image", &sensor_msgs_msg_dds__Image__desc, 0, 0},
    {"cloud", &sensor_msgs_msg_dds__PointCloud2__desc, 0, 0},
    {"frame", &bpa_msgs_msg_dds__RgbdFrame__desc, 0, 0},
    {"interpretations", &bpa_msgs_msg_dds__SceneInterpretations__desc, 0, 0},
    {"detections", &vision_msgs_msg_dds__Detection3DArray__desc, 0, 0},
    {"markers", &visualization_msgs_msg_dds__MarkerArray__desc, 0, 0},
    {"events", &rcl_interfaces_msg_dds__ParameterEvent__desc, 0, 0},
};
enum { kEchoes = sizeof(echoes) / sizeof(echoes[0]) };

static dds_entity_t check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "cyclone_echo: %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

static dds_entity_t topic(dds_entity_t participant, const char* prefix, const Echo* echo) {
  char name[64];
  snprintf(name, sizeof(name), "%s%s", prefix, echo->name);
  return check(dds_create_topic(participant, echo->type, name, NULL, NULL), name);
}

static void serve(Echo* echo) {
  void* sample[1] = {NULL};
  dds_sample_info_t info[1];
  while (dds_take(echo->reader, sample, info, 1, 1) > 0) {
    if (info[0].valid_data) dds_write(echo->writer, sample[0]);
    dds_return_loan(echo->reader, sample, 1);
    sample[0] = NULL;
  }
}

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) return 2;
  dds_entity_t participant =
      check(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  const dds_data_representation_id_t xcdr2 = DDS_DATA_REPRESENTATION_XCDR2;
  if (argc == 3) dds_qset_data_representation(qos, 1, &xcdr2);
  for (int i = 0; i < kEchoes; ++i) {
    Echo* echo = &echoes[i];
    echo->reader = check(
        dds_create_reader(participant, topic(participant, "rt/in/", echo), qos, NULL), "reader");
    echo->writer = check(
        dds_create_writer(participant, topic(participant, "rt/out/", echo), qos, NULL), "writer");
  }
  struct pollfd input = {STDIN_FILENO, POLLIN, 0};
  const time_t end = time(NULL) + 120;
  while (time(NULL) < end && poll(&input, 1, 2) == 0) {
    for (int i = 0; i < kEchoes; ++i) serve(&echoes[i]);
  }
  dds_delete_qos(qos);
  dds_delete(participant);
  return 0;
}
