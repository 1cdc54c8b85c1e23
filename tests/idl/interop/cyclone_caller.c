// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A client on Eclipse Cyclone DDS that calls unload_model as rmw_cyclonedds does. Usage:
// cyclone_caller DOMAIN CALLS [SERVICE]; exits 0 when every call was answered within 5 s. Without a
// SERVICE it is /interop/unload_model, and the answers must tell the name and number of the model.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "dds/dds.h"
#include "framed_service.h"

typedef bpa_msgs_srv_dds__UnloadModel_Request_ Request;
typedef bpa_msgs_srv_dds__UnloadModel_Response_ Response;

static const uint64_t kClient = 0x1122334455667788u;

static dds_entity_t check(dds_entity_t entity, const char* what) {
  if (entity < 0) {
    fprintf(stderr, "cyclone_caller: %s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

/* As rmw_cyclonedds judges it: as many request readers as reply writers, and some. */
static int wait_for_service(dds_entity_t writer, dds_entity_t reader) {
  for (int i = 0; i < 2500; ++i) {
    dds_publication_matched_status_t requests;
    dds_subscription_matched_status_t replies;
    dds_get_publication_matched_status(writer, &requests);
    dds_get_subscription_matched_status(reader, &replies);
    if (requests.current_count > 0 && requests.current_count == replies.current_count) return 1;
    usleep(2000);
  }
  return 0;
}

/* A null text: any answer to this request will do. */
static int answered(dds_entity_t reader, int64_t sequence, const char* text) {
  void* sample[1] = {NULL};
  dds_sample_info_t info[1];
  int found = 0;
  while (!found && dds_take(reader, sample, info, 1, 1) > 0) {
    const Response* response = sample[0];
    found = info[0].valid_data && response->client_id == kClient && response->request_number == sequence &&
            (text == NULL || (response->success && strcmp(response->status.message, text) == 0 &&
                              response->database_version == (int32_t)sequence));
    dds_return_loan(reader, sample, 1);
    sample[0] = NULL;
  }
  return found;
}

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) return 2;
  const char* service = argc == 4 ? argv[3] : "/interop/unload_model";
  char request_name[256], reply_name[256];
  snprintf(request_name, sizeof(request_name), "rq%sRequest", service);
  snprintf(reply_name, sizeof(reply_name), "rr%sReply", service);
  dds_entity_t participant =
      check(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
  dds_qset_userdata(qos, "clientid=1.2.3;", 15);
  dds_entity_t request_topic =
      check(dds_create_topic(participant, &bpa_msgs_srv_dds__UnloadModel_Request__desc,
                             request_name, NULL, NULL),
            "request topic");
  dds_entity_t reply_topic =
      check(dds_create_topic(participant, &bpa_msgs_srv_dds__UnloadModel_Response__desc,
                             reply_name, NULL, NULL),
            "reply topic");
  dds_entity_t reader = check(dds_create_reader(participant, reply_topic, qos, NULL), "reader");
  dds_entity_t writer = check(dds_create_writer(participant, request_topic, qos, NULL), "writer");
  int missing = wait_for_service(writer, reader) ? 0 : atoi(argv[2]);
  for (int64_t i = 1; missing == 0 && i <= atoi(argv[2]); ++i) {
    char name[32];
    snprintf(name, sizeof(name), "model %d", (int)i);
    Request request = {kClient, i, name};
    check(dds_write(writer, &request), "write");
    int found = 0;
    for (int j = 0; j < 2500 && !found; ++j) {
      found = answered(reader, i, argc == 4 ? NULL : name);
      if (!found) usleep(2000);
    }
    if (!found) ++missing;
  }
  dds_delete_qos(qos);
  dds_delete(participant);
  if (missing != 0) fprintf(stderr, "cyclone_caller: %d calls were not answered\n", missing);
  return missing == 0 ? 0 : 1;
}
