// A reference in C with Cyclone DDS: no code of Sinew but the types of its topics. Reads joint_state, writes reference.
//
// Every joint swings from where it was when the robot was armed:
//
//     q(t) = q0 + A (1 - cos(2 pi f t)) / 2,   A: --amplitude rad (m), f: --frequency Hz,   t: ticks times the period
//
// which begins at rest. While the robot is not armed it asks for nothing (idle, the measured positions). A stand-by
// takes q0 from the owner's reference, so that a handover makes no jump. Options: --name NAME --domain N [--lockstep]
// [--amplitude RAD] [--frequency HZ]; --seed N is ignored. Other options are refused.
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "endpoints.h"
#include "joint.h"
#include "operator.h"
#include "reference.h"
#include "status.h"

enum { kMostJoints = 12 };
static const double kTurn_rad = 6.283185307179586;

static volatile sig_atomic_t stop_requested;
static void OnSignal(int number) { (void)number, stop_requested = 1; }

typedef struct {
  double amplitude_rad, frequency_Hz;
  double start_rad[kMostJoints], last_rad[kMostJoints];  // q0; the last position that was a number
  uint64_t session, tick, armed_tick;
  bool moving;
} Swing;

// How far the swing is from its start, and its derivatives.
static void Displacement(const Swing *s, double time_s, double *position, double *velocity, double *acceleration) {
  const double rate = kTurn_rad * s->frequency_Hz, phase = rate * time_s;
  *position = 0.5 * s->amplitude_rad * (1.0 - cos(phase));
  *velocity = 0.5 * s->amplitude_rad * rate * sin(phase);
  *acceleration = 0.5 * s->amplitude_rad * rate * rate * cos(phase);
}

static double TimeOf(const Swing *s, uint64_t tick, double period_s) {
  return s->moving && tick > s->armed_tick ? period_s * (double)(tick - s->armed_tick) : 0.0;
}

static void Step(Swing *s, const sinew_msg_JointState *state, sinew_msg_Reference *out) {
  memset(out, 0, sizeof *out);
  out->header = state->header;
  out->state_tick = state->header.tick;
  out->previous_tick = s->session == state->header.session_id ? s->tick : UINT64_MAX;
  out->joint_count = state->joint_count;
  if (s->session != state->header.session_id) {
    memset(s->last_rad, 0, sizeof s->last_rad);
    s->moving = false;
  }
  for (int i = 0; i < state->joint_count; ++i) {
    const bool known = state->valid[i] && isfinite(state->position_rad[i]);
    if (known) s->last_rad[i] = state->position_rad[i];
    out->stale = out->stale || !known;
  }
  const bool armed = state->robot_state == sinew_msg_ROBOT_ARMED || state->robot_state == sinew_msg_ROBOT_DAMPED;
  if (armed && !s->moving) {
    memcpy(s->start_rad, s->last_rad, sizeof s->start_rad);
    s->armed_tick = state->header.tick;
  }
  s->moving = armed, s->session = state->header.session_id, s->tick = state->header.tick;
  out->idle = !armed;
  double position = 0.0, velocity = 0.0, acceleration = 0.0;
  if (armed) Displacement(s, TimeOf(s, s->tick, state->period_s), &position, &velocity, &acceleration);
  for (int i = 0; i < state->joint_count; ++i) {
    out->position_rad[i] = armed ? s->start_rad[i] + position : s->last_rad[i];
    out->velocity_rad_s[i] = velocity;
    out->acceleration_rad_s2[i] = acceleration;
  }
}

// A stand-by: the swing passes through what the owner asked for at that tick.
static void Follow(Swing *s, const sinew_msg_Reference *theirs, double period_s) {
  if (!s->moving || theirs->idle || theirs->header.session_id != s->session || theirs->joint_count > kMostJoints) return;
  double position, velocity, acceleration;
  Displacement(s, TimeOf(s, theirs->header.tick, period_s), &position, &velocity, &acceleration);
  for (int i = 0; i < theirs->joint_count; ++i) {
    if (isfinite(theirs->position_rad[i])) s->start_rad[i] = theirs->position_rad[i] - position;
  }
}

static bool ReadNumber(const char *text, double *value) {
  char *end = NULL;
  *value = strtod(text, &end);
  return end != text && *end == '\0' && isfinite(*value);
}

int main(int argc, char **argv) {
  const char *name = "reference-c";
  int domain = 0;
  Swing swing = {.amplitude_rad = 0.2, .frequency_Hz = 0.5};
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (strcmp(argv[i], "--lockstep") == 0) lockstep = true;
    else if (strcmp(argv[i], "--name") == 0 && has_value) name = argv[++i];
    else if (strcmp(argv[i], "--domain") == 0 && has_value) domain = atoi(argv[++i]);
    else if (strcmp(argv[i], "--seed") == 0 && has_value) ++i;
    else if (strcmp(argv[i], "--amplitude") == 0 && has_value && ReadNumber(argv[i + 1], &swing.amplitude_rad)) ++i;
    else if (strcmp(argv[i], "--frequency") == 0 && has_value && ReadNumber(argv[i + 1], &swing.frequency_Hz)) ++i;
    else return fprintf(stderr, "%s: unknown option, or no number after it\n", argv[i]), 2;
  }
  signal(SIGINT, OnSignal), signal(SIGTERM, OnSignal), signal(SIGHUP, OnSignal);

  dds_qos_t *named = dds_create_qos();
  dds_qset_entity_name(named, name);
  participant = Check(dds_create_participant((dds_domainid_t)domain, named, NULL), "participant");
  dds_delete_qos(named);
  const dds_entity_t reference_topic = Topic(sinew_msg_Reference_desc, "reference", SINEW_TYPE_REFERENCE);
  const dds_entity_t states = Reader(Topic(sinew_msg_JointState_desc, "joint_state", SINEW_TYPE_JOINT_STATE), kState);
  const dds_entity_t operators =
      Reader(Topic(sinew_msg_OperatorCommand_desc, "operator_command", SINEW_TYPE_OPERATOR_COMMAND), kEvent);
  const dds_entity_t owner = Reader(reference_topic, kControl);
  const dds_entity_t publications = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
  const dds_entity_t references = Writer(reference_topic, kControl);
  const dds_entity_t statuses =
      Writer(Topic(sinew_msg_ComponentStatus_desc, "component_status", SINEW_TYPE_COMPONENT_STATUS), kLatched);
  const dds_entity_t state_comes = WaitsetOf(states);

  static sinew_msg_ComponentStatus status;
  static sinew_msg_JointState state;
  static sinew_msg_Reference reference, theirs;
  static sinew_msg_OperatorCommand word;
  snprintf(status.name, sizeof status.name, "%s", name);
  snprintf(status.component_kind, sizeof status.component_kind, "reference");
  snprintf(status.idl_hash, sizeof status.idl_hash, "%s", SINEW_TOPICS_HASH);
  gethostname(status.host, sizeof status.host - 1);
  status.process_id = (uint32_t)getpid();
  dds_instance_handle_t own_handle = 0;
  dds_get_instance_handle(references, &own_handle);

  bool settled = lockstep, ended = false;
  dds_time_t heard = 0, status_due = 0;  // heard: the first joint_state; before it, others need not have been discovered
  uint32_t strength = kJoining;
  const uint32_t first = FirstStrength();
  while (!stop_requested && !ended) {
    if (dds_time() >= status_due) {
      dds_write(statuses, &status);
      status_due = dds_time() + DDS_SECS(1);
    }
    if (!settled && heard != 0 && dds_time() - heard > DDS_SECS(1)) {
      const uint32_t below = FindRivals(publications, references, "reference").lowest - 1;
      SetStrength(references, strength = below < first ? below : first);
      settled = true;
    }
    dds_waitset_wait_until(state_comes, NULL, 0, dds_time() + DDS_MSECS(50));
    while (Take(operators, &word)) {
      if (word.action == sinew_msg_OPERATOR_HANDOVER && word.header.session_id == swing.session &&
          strcmp(word.role, "reference") == 0 && strcmp(word.target, name) == 0 &&
          word.header.origin != sinew_msg_ORIGIN_REPLAY) {
        const uint32_t highest = FindRivals(publications, references, "reference").highest;
        const uint32_t above = highest < first ? first : highest + 1;
        if (strength <= highest) SetStrength(references, strength = above);
        settled = true;
      }
    }
    if (!Take(states, &state)) continue;
    if (heard == 0) heard = dds_time();
    if (state.joint_count > kMostJoints) {
      ++status.malformed_samples;
      continue;
    }
    const uint64_t gap = state.header.tick - swing.tick;
    if (settled && !lockstep && state.header.session_id == swing.session && gap > 5 &&
        (double)gap * state.period_s > 0.02) {
      const uint32_t lowest = FindRivals(publications, references, "reference").lowest;  // who was replaced stays so
      if (lowest <= strength) SetStrength(references, strength = lowest - 1);
    }
    dds_sample_info_t info;
    void *sample = &theirs;
    while (!lockstep && dds_take(owner, &sample, &info, 1, 1) > 0) {
      if (info.valid_data && info.publication_handle != own_handle) Follow(&swing, &theirs, state.period_s);
    }
    Step(&swing, &state, &reference);
    if (dds_write(references, &reference) != DDS_RETCODE_OK) ++status.write_failures;
    status.header = state.header;
    status.stale_inputs += reference.stale ? 1u : 0u;
    if (++status.cycles == 1) status.state = sinew_msg_COMPONENT_ACTIVE, status_due = 0;
    ended = state.last_tick;
  }
  if (lockstep) dds_wait_for_acks(references, DDS_SECS(2));
  status.state = sinew_msg_COMPONENT_STOPPED;
  dds_write(statuses, &status);
  dds_delete(participant);
  return 0;
}
