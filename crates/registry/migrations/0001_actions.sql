-- Schema 1: the paper's 21 motion primitives and the high-level actions composed of them.
-- This file is never edited once released; a change is a new file with the next number.

-- "RSRR" in the header names the file as a RoboRegistry, whatever its path.
PRAGMA application_id = 0x52535252;

-- One row: which generation of the seed library has been put in, so that none comes twice.
CREATE TABLE registry (
    only_row        INTEGER PRIMARY KEY CHECK (only_row = 1),
    seed_generation INTEGER NOT NULL CHECK (seed_generation >= 0)
) STRICT;
INSERT INTO registry VALUES (1, 0);

-- Table 1 of the paper. Joints and positions are numbered as on the link.
CREATE TABLE primitive (
    number   INTEGER PRIMARY KEY CHECK (number BETWEEN 1 AND 21),
    name     TEXT    NOT NULL UNIQUE,
    joint    INTEGER NOT NULL CHECK (joint = (number - 1) / 3),
    position INTEGER NOT NULL CHECK (position = (number - 1) % 3 + 1),
    UNIQUE (number, joint)
) STRICT;
INSERT INTO primitive (number, name, joint, position) VALUES
    ( 1, 'right-arm-up',    0, 1), ( 2, 'right-arm-front', 0, 2), ( 3, 'right-arm-down',  0, 3),
    ( 4, 'left-arm-up',     1, 1), ( 5, 'left-arm-front',  1, 2), ( 6, 'left-arm-down',   1, 3),
    ( 7, 'right-hand-in',   2, 1), ( 8, 'right-hand-mid',  2, 2), ( 9, 'right-hand-open', 2, 3),
    (10, 'left-hand-in',    3, 1), (11, 'left-hand-mid',   3, 2), (12, 'left-hand-open',  3, 3),
    (13, 'tilt-left',       4, 1), (14, 'tilt-mid',        4, 2), (15, 'tilt-right',      4, 3),
    (16, 'right-leg-front', 5, 1), (17, 'right-leg-mid',   5, 2), (18, 'right-leg-back',  5, 3),
    (19, 'left-leg-front',  6, 1), (20, 'left-leg-mid',    6, 2), (21, 'left-leg-back',   6, 3);

-- An action by name. A removed action keeps its row and its versions; saving it again revives it.
CREATE TABLE action (
    id             INTEGER PRIMARY KEY,
    name           TEXT    NOT NULL UNIQUE
                   CHECK (length(name) BETWEEN 1 AND 64
                          AND name GLOB '[a-z]*'
                          AND name NOT GLOB '*[^a-z0-9-]*'),
    created_ms     INTEGER NOT NULL,
    removed_ms     INTEGER,
    latest_version INTEGER NOT NULL CHECK (latest_version >= 1),
    FOREIGN KEY (id, latest_version) REFERENCES action_version (action_id, version)
        DEFERRABLE INITIALLY DEFERRED
) STRICT;

-- What an action was from one save to the next. Tags are separated by single spaces.
CREATE TABLE action_version (
    action_id   INTEGER NOT NULL REFERENCES action (id),
    version     INTEGER NOT NULL CHECK (version >= 1),
    saved_ms    INTEGER NOT NULL,
    description TEXT    NOT NULL CHECK (length(description) <= 2000),
    tags        TEXT    NOT NULL CHECK (tags NOT GLOB '*[^a-z0-9 -]*'),
    PRIMARY KEY (action_id, version)
) STRICT, WITHOUT ROWID;

-- A step moves joints for a duration (no primitive: a pause) or plays another action.
CREATE TABLE action_step (
    action_id        INTEGER NOT NULL,
    version          INTEGER NOT NULL,
    place            INTEGER NOT NULL CHECK (place BETWEEN 1 AND 1000),
    duration_ms      INTEGER CHECK (duration_ms BETWEEN 1 AND 65535),
    ending_bumpers   INTEGER CHECK (ending_bumpers BETWEEN 0 AND 63),
    played_action_id INTEGER REFERENCES action (id),
    times            INTEGER NOT NULL CHECK (times BETWEEN 1 AND 1000),
    PRIMARY KEY (action_id, version, place),
    FOREIGN KEY (action_id, version) REFERENCES action_version (action_id, version),
    CHECK ((played_action_id IS NULL) = (duration_ms IS NOT NULL)),
    CHECK ((duration_ms IS NULL) = (ending_bumpers IS NULL)),
    CHECK (played_action_id <> action_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX action_step_plays ON action_step (played_action_id)
    WHERE played_action_id IS NOT NULL;

-- The primitives that run together in a step: at most one a joint, so never opposite positions.
CREATE TABLE step_primitive (
    action_id INTEGER NOT NULL,
    version   INTEGER NOT NULL,
    place     INTEGER NOT NULL,
    joint     INTEGER NOT NULL,
    primitive INTEGER NOT NULL,
    PRIMARY KEY (action_id, version, place, joint),
    FOREIGN KEY (action_id, version, place) REFERENCES action_step (action_id, version, place),
    FOREIGN KEY (primitive, joint) REFERENCES primitive (number, joint)
) STRICT, WITHOUT ROWID;

-- The primitives are the robot's own and fixed; versions stay as they were saved.
CREATE TRIGGER primitive_insert BEFORE INSERT ON primitive
    BEGIN SELECT RAISE(ABORT, 'the 21 motion primitives are fixed'); END;
CREATE TRIGGER primitive_update BEFORE UPDATE ON primitive
    BEGIN SELECT RAISE(ABORT, 'the 21 motion primitives are fixed'); END;
CREATE TRIGGER primitive_delete BEFORE DELETE ON primitive
    BEGIN SELECT RAISE(ABORT, 'the 21 motion primitives are fixed'); END;
CREATE TRIGGER action_delete BEFORE DELETE ON action
    BEGIN SELECT RAISE(ABORT, 'actions are kept'); END;
CREATE TRIGGER action_version_update BEFORE UPDATE ON action_version
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER action_version_delete BEFORE DELETE ON action_version
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER action_step_update BEFORE UPDATE ON action_step
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER action_step_delete BEFORE DELETE ON action_step
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER step_primitive_update BEFORE UPDATE ON step_primitive
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER step_primitive_delete BEFORE DELETE ON step_primitive
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
