/* SPDX-License-Identifier: MIT OR Apache-2.0 */
/*
 * What is true of the controller between any two of its routines. The one list that the fuzz
 * targets test after every event and that the proof by induction assumes before an event and
 * asserts behind it.
 *
 * A template: who includes it says by REQUIRE(condition) what is to be done with each condition,
 * by INVARIANTS(part) what the function of each part is called, and by EACH(index, count) how to
 * go over the places of a ring: a loop, or to assert, any one place, which is as good.
 */

static void INVARIANTS(reception)(void)
{
    uint8_t index;
    uint8_t waiting = (uint8_t)(reception_ring.put - reception_ring.taken);

    REQUIRE(waiting <= RECEIVE_RING_LENGTH);
    EACH(index, RECEIVE_RING_LENGTH)
    {
        REQUIRE(reception_ring.sorts[index] <= LINE_ERROR_OVERRUN + 1u);
    }
    REQUIRE(reception.state <= RECEPTION_CHECK);
    REQUIRE(reception.content_used <= ACTION_CONTENT_LENGTH);
    if (reception.state == RECEPTION_SYNCHRONIZATION) {
        REQUIRE(reception.content_index == 0u || reception.content_index == GROUP_DATA_LENGTH);
        REQUIRE(reception.content_used <= reception.content_index);
    } else if (reception.state == RECEPTION_DATA) {
        REQUIRE(reception.content_index < ACTION_CONTENT_LENGTH);
        REQUIRE(reception.content_used <= reception.content_index);
        REQUIRE(reception.group_index == reception.content_index % GROUP_DATA_LENGTH);
    } else if (reception.state == RECEPTION_CHECK) {
        REQUIRE(reception.content_index == ACTION_CONTENT_LENGTH);
        REQUIRE(reception.group_index < CHECK_LENGTH);
    }
}

static void INVARIANTS(transmission)(void)
{
    REQUIRE(transmission.next <= SYNCHRONIZATION_PACKAGE_LENGTH);
    /* The session of nobody has no numbers. */
    REQUIRE(command.session != 0u || (!command.any_executed && command.last_sequence == 0u));
    REQUIRE(command.any_executed || command.last_sequence == 0u);
    REQUIRE(communication.cause <= STOP_CAUSE_WATCHDOG);
    REQUIRE(dead_man.timeout_ms == 0u || dead_man.timeout_ms >= DEAD_MAN_MS_MIN);
    REQUIRE(dead_man.timeout_ms <= DEAD_MAN_MS_MAX);
}

#ifdef RSAPIEN_MOTION

static void INVARIANTS(joint)(uint8_t joint)
{
    const struct joint_drive *drive = &joints.drive[joint];
    const uint8_t shift = (uint8_t)(2u * (joint % 4u));
    const uint8_t moving = joints.motors.towards_first | joints.motors.towards_last;
    const uint8_t target = drive->target;

    REQUIRE(drive->full_travel_ms >= TRAVEL_MS_MIN);
    REQUIRE(drive->full_travel_ms <= TRAVEL_MS_MAX);
    REQUIRE(drive->middle_ms == drive->full_travel_ms / 2u);
    REQUIRE(drive->overrun_ms == drive->full_travel_ms / 8u);
    REQUIRE(drive->run_ms == drive->full_travel_ms + drive->overrun_ms);
    REQUIRE(drive->position_ms <= drive->full_travel_ms);
    REQUIRE((target & (uint8_t)~(3u << shift)) == 0u);
    if ((moving & (1u << joint)) != 0u) {
        REQUIRE(drive->state >= JOINT_STATE_HOMING && drive->state <= JOINT_STATE_SEARCHING_BACK);
        REQUIRE(drive->remaining_ms != 0u);
        REQUIRE(target != 0u);
        /* Only an arm has a switch to search for. */
        REQUIRE(joint <= JOINT_LEFT_ARM || drive->state <= JOINT_STATE_TRAVELLING);
        REQUIRE(drive->state == JOINT_STATE_TRAVELLING || target == POSITION_MIDDLE << shift);
    }
}

static void INVARIANTS(joints)(void)
{
    const struct motors *motors = &joints.motors;
    const uint8_t on_first = motors->towards_first & (uint8_t)~motors->dead_time;
    const uint8_t on_last = motors->towards_last & (uint8_t)~motors->dead_time;
    const uint8_t moving = motors->towards_first | motors->towards_last;
    uint8_t joint;

    REQUIRE((motors->towards_first & motors->towards_last) == 0u);
    REQUIRE((motors->driven_first & motors->driven_last) == 0u);
    REQUIRE(moving < 1u << JOINT_COUNT);
    REQUIRE((motors->driven_first | motors->driven_last) < 1u << JOINT_COUNT);
    REQUIRE((motors->dead_time & (uint8_t)~moving) == 0u);
    REQUIRE(motors->start_first == 0u && motors->start_last == 0u);
    REQUIRE(motors->pins_first == on_first && motors->pins_last == on_last);
    /* What is on the pins was not on in the other sense in this tick or the one before. */
    REQUIRE((on_first & (uint8_t)~motors->driven_first) == 0u);
    REQUIRE((on_last & (uint8_t)~motors->driven_last) == 0u);
    REQUIRE(joints.switches_closed <= (SWITCH_LEFT | SWITCH_RIGHT));
    for (joint = 0; joint < JOINT_COUNT; joint++) {
        INVARIANTS(joint)(joint);
    }
}

static void INVARIANTS(motion)(void)
{
    REQUIRE(motion.mode <= MODE_HELD);
    REQUIRE(motion.mode != MODE_EXECUTING || motion.step_remaining_ms != 0u);
    REQUIRE(motion.mode != MODE_EXECUTING || motion.initialised);
    REQUIRE(motion.mode != MODE_IDLE || motion.initialised);
    REQUIRE(motion.mode != MODE_INITIALISING || !motion.initialised);
    if (motion.mode == MODE_FRESH || motion.mode == MODE_STOPPED || motion.mode == MODE_HELD) {
        REQUIRE((joints.motors.towards_first | joints.motors.towards_last) == 0u);
    }
    REQUIRE(motion.mode == MODE_INITIALISING || motion.mode == MODE_EXECUTING ||
            queue.count == 0u);
    REQUIRE(queue.count <= QUEUE_LENGTH);
    REQUIRE(queue.first <= QUEUE_LENGTH);
}

static void INVARIANTS(queue)(void)
{
    uint8_t index;

    EACH(index, QUEUE_LENGTH)
    {
        const uint8_t place = (uint8_t)((queue.first + index) % QUEUE_LENGTH);
        const bool waits = index < queue.count;

        REQUIRE(!waits || (queue.duration_low_ms[place] | queue.duration_high_ms[place]) != 0u);
        REQUIRE(!waits || queue.pose_high[place] <= STEP_POSE_HIGH_MASK);
        REQUIRE(!waits || queue.ending_bumpers[place] <= STEP_BUMPERS_MASK);
    }
}

static void INVARIANTS(bumpers)(void)
{
    uint8_t index;

    REQUIRE(bumpers.pressed < 1u << BUMPER_COUNT);
    REQUIRE(bumpers.unsettled < 1u << BUMPER_COUNT);
    for (index = 0; index < BUMPER_COUNT; index++) {
        const bool unsettled = (bumpers.unsettled & (1u << index)) != 0u;

        REQUIRE(bumpers.presses[index] <= 0x0Fu);
        REQUIRE(bumpers.differing[index] < BUMPER_DEBOUNCE_TESTS);
        REQUIRE(unsettled || bumpers.differing[index] == 0u);
    }
}

#else

static void INVARIANTS(axis)(const struct axis *axis, int16_t limit_centideg)
{
    REQUIRE(axis->position_centideg >= -limit_centideg);
    REQUIRE(axis->position_centideg <= limit_centideg);
    REQUIRE(axis->target_centideg >= -limit_centideg);
    REQUIRE(axis->target_centideg <= limit_centideg);
    REQUIRE(axis->tenths < 10u);
}

static void INVARIANTS(speed)(uint8_t step_centideg, uint8_t step_tenths)
{
    REQUIRE(step_tenths < 10u);
    REQUIRE(step_centideg * 10u + step_tenths <= AXIS_SPEED_MAX_DEG_PER_S);
}

static void INVARIANTS(camera)(void)
{
    const bool moving = camera.pan.position_centideg != camera.pan.target_centideg ||
                        camera.tilt.position_centideg != camera.tilt.target_centideg;
    const bool under_way = camera.mode == MODE_INITIALISING || camera.mode == MODE_EXECUTING;

    REQUIRE(camera.mode <= MODE_HELD);
    INVARIANTS(axis)(&camera.pan, PAN_CENTIDEG_MAX);
    INVARIANTS(axis)(&camera.tilt, TILT_CENTIDEG_MAX);
    INVARIANTS(speed)(camera.step_centideg, camera.step_tenths);
    INVARIANTS(speed)(camera.aim.step_centideg, camera.aim.step_tenths);
    REQUIRE(camera.aim.pan_centideg >= -PAN_CENTIDEG_MAX);
    REQUIRE(camera.aim.pan_centideg <= PAN_CENTIDEG_MAX);
    REQUIRE(camera.aim.tilt_centideg >= -TILT_CENTIDEG_MAX);
    REQUIRE(camera.aim.tilt_centideg <= TILT_CENTIDEG_MAX);
    REQUIRE(camera.settle_ms <= HOME_SETTLE_MS);
    /* Axes move only on somebody's word, servos without a known place only during HOME. */
    REQUIRE(!moving || under_way);
    REQUIRE(camera.settle_ms == 0u || camera.mode == MODE_INITIALISING);
    REQUIRE(!camera.aim_waits || camera.mode == MODE_INITIALISING);
    REQUIRE(camera.driven == (camera.homed || camera.mode == MODE_INITIALISING));
    REQUIRE(camera.mode != MODE_EXECUTING || camera.homed);
    REQUIRE(camera.mode != MODE_IDLE || camera.homed);
    /* What moves arrives: a speed of nothing would never. */
    REQUIRE(!moving || camera.step_centideg != 0u || camera.step_tenths != 0u);
    REQUIRE(!camera.aim_waits || camera.aim.step_centideg != 0u || camera.aim.step_tenths != 0u);
}

#endif

static void INVARIANTS(controller)(void)
{
    INVARIANTS(reception)();
    INVARIANTS(transmission)();
#ifdef RSAPIEN_MOTION
    INVARIANTS(joints)();
    INVARIANTS(motion)();
    INVARIANTS(queue)();
    INVARIANTS(bumpers)();
#else
    INVARIANTS(camera)();
#endif
}

#undef REQUIRE
#undef INVARIANTS
#undef EACH
