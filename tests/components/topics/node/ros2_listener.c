// A peer that knows the names of ROS 2 alone: Cyclone DDS, topic rt/joint_state, type sinew::msg::dds_::JointState_.
// Usage: ros2_listener DOMAIN. Prints the first sample and ends with 0, with 1 after ten seconds without one.
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>

#include "joint.h"

static dds_entity_t Check(dds_entity_t entity, const char *what) {
  if (entity < 0) {
    fprintf(stderr, "%s: %s\n", what, dds_strretcode(-entity));
    exit(2);
  }
  return entity;
}

int main(int argc, char **argv) {
  if (argc != 2) return fprintf(stderr, "usage: ros2_listener DOMAIN\n"), 2;
  const dds_entity_t participant =
      Check(dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL), "participant");
  dds_topic_descriptor_t type = sinew_msg_JointState_desc;
  type.m_typename = "sinew::msg::dds_::JointState_";
  const dds_entity_t topic = Check(dds_create_topic(participant, &type, "rt/joint_state", NULL, NULL), "topic");
  const dds_entity_t reader = Check(dds_create_reader(participant, topic, NULL, NULL), "reader");
  const dds_entity_t waitset = Check(dds_create_waitset(participant), "waitset");
  dds_waitset_attach(waitset, Check(dds_create_readcondition(reader, DDS_ANY_STATE), "condition"), 0);
  static sinew_msg_JointState state;
  void *sample = &state;
  dds_sample_info_t info = {.valid_data = false};
  const dds_time_t end = dds_time() + DDS_SECS(10);
  while (!info.valid_data && dds_time() < end) {
    dds_waitset_wait_until(waitset, NULL, 0, end);
    while (!info.valid_data && dds_take(reader, &sample, &info, 1, 1) > 0) {
    }
  }
  if (info.valid_data) printf("joints %d position %.17g\n", state.joint_count, state.position_rad[0]);
  dds_delete(participant);
  return info.valid_data ? 0 : 1;
}
