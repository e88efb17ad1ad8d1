// A controller of one joint in C with Cyclone DDS: no code of Sinew but the types of its topics.
//
// PD with an integral that follows the owner's command until this one is handed over to. Options:
// --name NAME --domain N [--lockstep]; --seed N is ignored. Other options are refused.
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

static const double kProportional = 0.243, kIntegral = 0.0747, kDerivative = 0.0123, kLimit_Nm = 0.398;
static const double kGrace_s = 0.035;  // a late reference is continued for this long, as in a take-over
enum { kMostJoints = 12 };

static volatile sig_atomic_t stop_requested;
static void OnSignal(int number) { (void)number, stop_requested = 1; }

typedef struct {
  double integral_Nm, feedback_Nm, target_rad;
  uint64_t session, tick;
  bool driving, estopped;
} Controller;

static double Clamped(double value) { return fmax(-kLimit_Nm, fmin(kLimit_Nm, value)); }

static void Step(Controller *c, const sinew_msg_JointState *s, const sinew_msg_Reference *r, bool fresh,
                 sinew_msg_JointCommand *command) {
  const double position_rad = s->position_rad[0], velocity_rad_s = s->velocity_rad_s[0];
  const bool armed = s->robot_state == sinew_msg_ROBOT_ARMED || s->robot_state == sinew_msg_ROBOT_DAMPED;
  const bool known = s->valid[0] && isfinite(position_rad) && isfinite(velocity_rad_s);
  const bool drives = armed && known && !c->estopped;
  if (!c->driving || c->session != s->header.session_id) c->target_rad = position_rad, c->integral_Nm = 0.0;
  c->driving = drives, c->session = s->header.session_id, c->tick = s->header.tick;

  const bool late = r->header.tick < s->header.tick, of_session = r->header.session_id == s->header.session_id;
  const double late_s = late ? s->period_s * (double)(s->header.tick - r->header.tick) : 0.0;
  const bool led = of_session && late_s <= kGrace_s && !r->idle && !r->stale && isfinite(r->position_rad[0]) &&
                   isfinite(r->velocity_rad_s[0]);
  if (led) c->target_rad = r->position_rad[0] + late_s * r->velocity_rad_s[0];
  memset(command, 0, sizeof *command);
  command->header = s->header;
  if (r->header.origin == sinew_msg_ORIGIN_REPLAY) command->header.origin = sinew_msg_ORIGIN_REPLAY;
  command->reference_tick = r->header.tick;
  command->stale = !known || !fresh || !(led || r->idle);
  command->joint_count = s->joint_count;
  if (!drives) return;
  const double error_rad = c->target_rad - position_rad;
  c->feedback_Nm = kProportional * error_rad + kDerivative * ((led ? r->velocity_rad_s[0] : 0.0) - velocity_rad_s);
  c->integral_Nm = Clamped(c->integral_Nm + kIntegral * error_rad * s->period_s);
  command->mode[0] = sinew_msg_COMMAND_TORQUE;
  command->motor_torque_Nm[0] = Clamped(c->feedback_Nm + c->integral_Nm);
}

int main(int argc, char **argv) {
  const char *name = "control-c";
  int domain = 0;
  for (int i = 1; i < argc; ++i) {
    const bool has_value = i + 1 < argc;
    if (strcmp(argv[i], "--lockstep") == 0) lockstep = true;
    else if (strcmp(argv[i], "--name") == 0 && has_value) name = argv[++i];
    else if (strcmp(argv[i], "--domain") == 0 && has_value) domain = atoi(argv[++i]);
    else if (strcmp(argv[i], "--seed") == 0 && has_value) ++i;
    else return fprintf(stderr, "%s: unknown option\n", argv[i]), 2;
  }
  signal(SIGINT, OnSignal), signal(SIGTERM, OnSignal), signal(SIGHUP, OnSignal);

  dds_qos_t *named = dds_create_qos();
  dds_qset_entity_name(named, name);
  participant = Check(dds_create_participant((dds_domainid_t)domain, named, NULL), "participant");
  dds_delete_qos(named);
  const dds_entity_t command_topic = Topic(sinew_msg_JointCommand_desc, "joint_command", SINEW_TYPE_JOINT_COMMAND);
  const dds_entity_t states = Reader(Topic(sinew_msg_JointState_desc, "joint_state", SINEW_TYPE_JOINT_STATE), kState);
  const dds_entity_t references = Reader(Topic(sinew_msg_Reference_desc, "reference", SINEW_TYPE_REFERENCE), kControl);
  const dds_entity_t operators =
      Reader(Topic(sinew_msg_OperatorCommand_desc, "operator_command", SINEW_TYPE_OPERATOR_COMMAND), kEvent);
  const dds_entity_t owner = Reader(command_topic, kControl);
  const dds_entity_t publications = dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, NULL, NULL);
  const dds_entity_t commands = Writer(command_topic, kControl);
  const dds_entity_t statuses =
      Writer(Topic(sinew_msg_ComponentStatus_desc, "component_status", SINEW_TYPE_COMPONENT_STATUS), kLatched);
  const dds_entity_t state_comes = WaitsetOf(states), reference_comes = WaitsetOf(references);

  static sinew_msg_ComponentStatus status;
  static sinew_msg_JointState state;
  static sinew_msg_Reference reference, newest;
  static sinew_msg_JointCommand command, theirs;
  static sinew_msg_OperatorCommand word;
  snprintf(status.name, sizeof status.name, "%s", name);
  snprintf(status.component_kind, sizeof status.component_kind, "control");
  snprintf(status.idl_hash, sizeof status.idl_hash, "%s", SINEW_TOPICS_HASH);
  gethostname(status.host, sizeof status.host - 1);
  status.process_id = (uint32_t)getpid();
  dds_instance_handle_t own_handle = 0;
  dds_get_instance_handle(commands, &own_handle);

  Controller controller = {0};
  bool waiting = false, settled = lockstep, known_reference = false, ended = false;
  dds_time_t heard = 0;  // the first joint_state: before it, others need not have been discovered
  dds_time_t give_up = 0, status_due = 0;
  uint32_t strength = kJoining;
  const uint32_t first = FirstStrength();
  while (!stop_requested && !ended) {
    if (dds_time() >= status_due) {
      dds_write(statuses, &status);
      status_due = dds_time() + DDS_SECS(1);
    }
    if (!settled && heard != 0 && dds_time() - heard > DDS_SECS(1)) {
      const uint32_t below = FindRivals(publications, commands, "joint_command").lowest - 1;
      SetStrength(commands, strength = below < first ? below : first);
      settled = true;
    }
    const dds_time_t limit = waiting && !lockstep ? give_up : dds_time() + DDS_MSECS(50);
    dds_waitset_wait_until(waiting ? reference_comes : state_comes, NULL, 0, limit);

    while (Take(operators, &word)) {
      const bool ours = word.header.session_id == controller.session;
      if (word.action == sinew_msg_OPERATOR_ESTOP) controller.estopped = true;
      if (word.action == sinew_msg_OPERATOR_RESET && ours) controller.estopped = false;
      if (word.action == sinew_msg_OPERATOR_HANDOVER && ours && strcmp(word.role, "control") == 0 &&
          strcmp(word.target, name) == 0 && word.header.origin != sinew_msg_ORIGIN_REPLAY) {
        const uint32_t highest = FindRivals(publications, commands, "joint_command").highest;
        const uint32_t above = highest < first ? first : highest + 1;
        if (strength <= highest) SetStrength(commands, strength = above);
        settled = true;
      }
    }
    // In real time the newest state counts, in lockstep each in its turn.
    if ((!waiting || !lockstep) && Take(states, &state)) {
      if (heard == 0) heard = dds_time();
      if (state.joint_count > kMostJoints) {
        ++status.malformed_samples;
        continue;
      }
      if (state.header.session_id != controller.session) known_reference = false;
      const uint64_t gap = state.header.tick - controller.tick;
      const double silent_s = (double)gap * state.period_s;
      if (settled && !lockstep && state.header.session_id == controller.session && gap > 5 && silent_s > 0.02) {
        const uint32_t lowest = FindRivals(publications, commands, "joint_command").lowest;  // who was replaced stays so
        if (lowest <= strength) SetStrength(commands, strength = lowest - 1);
      }
      waiting = true;
      give_up = dds_time() + (dds_time_t)(0.4e9 * state.period_s);  // components/topics/node/cut_off.h
    }
    if (!waiting) continue;
    bool reached = known_reference && reference.header.tick >= state.header.tick;
    while (!reached && Take(references, &newest)) {
      if (newest.joint_count > kMostJoints) {
        ++status.malformed_samples;
      } else if (newest.header.session_id == state.header.session_id) {
        reference = newest, known_reference = true;
        reached = reference.header.tick >= state.header.tick;
      }
    }
    if (!reached && (lockstep || dds_time() < give_up)) continue;
    waiting = false;
    dds_sample_info_t info;
    void *sample = &theirs;
    while (!lockstep && dds_take(owner, &sample, &info, 1, 1) > 0) {
      if (!info.valid_data || info.publication_handle == own_handle) continue;
      const bool same = theirs.header.session_id == controller.session && theirs.header.tick == controller.tick;
      if (same && isfinite(theirs.motor_torque_Nm[0])) {
        controller.integral_Nm = theirs.motor_torque_Nm[0] - controller.feedback_Nm;
      }
    }
    Step(&controller, &state, &reference, reached, &command);
    if (dds_write(commands, &command) != DDS_RETCODE_OK) ++status.write_failures;
    status.header = state.header;
    status.stale_inputs += command.stale ? 1u : 0u;
    if (++status.cycles == 1) status.state = sinew_msg_COMPONENT_ACTIVE, status_due = 0;
    ended = state.last_tick;
  }
  if (lockstep) dds_wait_for_acks(commands, DDS_SECS(2));
  status.state = sinew_msg_COMPONENT_STOPPED;
  dds_write(statuses, &status);
  dds_delete(participant);
  return 0;
}
