// Readers and writers of the robot's topics with Cyclone DDS: the QoS of idl/README.md, type names
// with the hash of their IDL, and ownership by the rules of components/topics/node/ownership.h. One
// thread; errors end the program.
#pragma once

#include <dds/dds.h>
#include <sinew_idl/topic_types.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const uint32_t kJoining = 1;  // ownership strength

static dds_entity_t participant;
static bool lockstep;

static dds_entity_t Check(dds_entity_t entity, const char *what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(1);
  }
  return entity;
}

typedef enum { kState, kControl, kEvent, kLatched } Profile;  // of idl/README.md

// Of an owner that is silent for longer a reader takes the next one: five periods at 200 Hz, so for
// a robot of at least that rate (Cyclone DDS 0.10 cannot change it later). Writers offer 20 ms to
// all readers.
static const dds_duration_t kReaderDeadline = DDS_MSECS(25), kWriterDeadline = DDS_MSECS(20);

static dds_qos_t *QosOf(Profile profile, dds_duration_t deadline) {
  dds_qos_t *qos = dds_create_qos();
  const bool stepped = lockstep && profile != kLatched;
  const bool reliable = stepped || profile == kEvent || profile == kLatched;
  dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       DDS_SECS(1));
  dds_qset_durability(qos, stepped || profile == kLatched ? DDS_DURABILITY_TRANSIENT_LOCAL
                                                          : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, stepped ? 256 : profile == kEvent ? 16 : 1);
  if (profile == kControl && !stepped) {
    dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
    dds_qset_deadline(qos, deadline);
  }
  return qos;
}

static dds_entity_t Topic(dds_topic_descriptor_t type, const char *name, const char *type_name) {
  type.m_typename = type_name;
  return Check(dds_create_topic(participant, &type, name, NULL, NULL), name);
}

static dds_entity_t Reader(dds_entity_t topic, Profile profile) {
  dds_qos_t *qos = QosOf(profile, kReaderDeadline);
  const dds_entity_t reader = Check(dds_create_reader(participant, topic, qos, NULL), "reader");
  dds_delete_qos(qos);
  return reader;
}

static dds_entity_t Writer(dds_entity_t topic, Profile profile) {
  dds_qos_t *qos = QosOf(profile, kWriterDeadline);
  if (profile == kControl && !lockstep) dds_qset_ownership_strength(qos, (int32_t)kJoining);
  const dds_entity_t writer = Check(dds_create_writer(participant, topic, qos, NULL), "writer");
  dds_delete_qos(qos);
  return writer;
}

static dds_entity_t WaitsetOf(dds_entity_t reader) {
  const dds_entity_t waitset = Check(dds_create_waitset(participant), "waitset");
  dds_waitset_attach(waitset, Check(dds_create_readcondition(reader, DDS_ANY_STATE), "condition"),
                     0);
  return waitset;
}

// Takes one sample; false: there is none.
static bool Take(dds_entity_t reader, void *sample) {
  dds_sample_info_t info;
  while (dds_take(reader, &sample, &info, 1, 1) > 0) {
    if (info.valid_data) return true;
  }
  return false;
}

// ---- ownership: the rules of components/topics/node/ownership.h

// FirstStrength for a writer that is started now: a step less every quarter of a second since 2024.
static uint32_t FirstStrength(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  const int64_t quarters = ((int64_t)now.tv_sec - 1704067200) * 4 + now.tv_nsec / 250000000;
  return (1u << 31) - (1u << 20) - (uint32_t)(quarters < 0 ? 0 : quarters);
}

typedef struct {
  uint32_t lowest,
      highest;  // of the other writers of a topic; lowest: of those that have settled
} Rivals;

static Rivals FindRivals(dds_entity_t publications, dds_entity_t writer, const char *topic) {
  Rivals rivals = {UINT32_MAX, 0};
  dds_guid_t own;
  dds_get_guid(writer, &own);
  void *samples[64] = {NULL};
  dds_sample_info_t info[64];
  const int count = dds_read_mask(publications, samples, info, 64, 64, DDS_ALIVE_INSTANCE_STATE);
  for (int i = 0; i < count; ++i) {
    const dds_builtintopic_endpoint_t *other = samples[i];
    int32_t strength = 0;
    if (!info[i].valid_data || strcmp(other->topic_name, topic) != 0) continue;
    if (memcmp(&other->key, &own, sizeof own) == 0) continue;
    dds_qget_ownership_strength(other->qos, &strength);
    if ((uint32_t)strength > rivals.highest) rivals.highest = (uint32_t)strength;
    if ((uint32_t)strength > kJoining && (uint32_t)strength < rivals.lowest)
      rivals.lowest = (uint32_t)strength;
  }
  if (count > 0) dds_return_loan(publications, samples, count);
  return rivals;
}

static void SetStrength(dds_entity_t writer, uint32_t strength) {
  dds_qos_t *qos = dds_create_qos();
  dds_qset_ownership_strength(qos, (int32_t)strength);
  Check(dds_set_qos(writer, qos), "ownership strength");
  dds_delete_qos(qos);
}
