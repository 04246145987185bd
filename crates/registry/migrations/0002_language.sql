-- Schema 2, first part: actions are texts. After this the program writes the texts of what schema 1
-- held as rows, and then runs the second part.
DROP TRIGGER action_version_update;

-- `source` is the action as it was written, word for word, and the truth; everything else that is
-- new can be made from it again, but for the trial.
ALTER TABLE action_version ADD COLUMN source   TEXT NOT NULL DEFAULT '';
-- What the checker warned of at the save, as JSON.
ALTER TABLE action_version ADD COLUMN warnings TEXT NOT NULL DEFAULT '[]';
-- How the motion went on the virtual body before it was saved, as JSON, where it was tried.
ALTER TABLE action_version ADD COLUMN trial    TEXT;

-- Of the version in force, with all it plays: renewed when that changes.
ALTER TABLE action ADD COLUMN duration_ms  INTEGER NOT NULL DEFAULT 0 CHECK (duration_ms >= 0);
ALTER TABLE action ADD COLUMN step_count   INTEGER NOT NULL DEFAULT 0 CHECK (step_count >= 0);
ALTER TABLE action ADD COLUMN joints       INTEGER NOT NULL DEFAULT 0 CHECK (joints BETWEEN 0 AND 127);
ALTER TABLE action ADD COLUMN content_hash TEXT    NOT NULL DEFAULT '';

-- What a version plays, as a step or when a bumper is met.
CREATE TABLE action_play (
    action_id        INTEGER NOT NULL,
    version          INTEGER NOT NULL,
    played_action_id INTEGER NOT NULL REFERENCES action (id),
    PRIMARY KEY (action_id, version, played_action_id),
    FOREIGN KEY (action_id, version) REFERENCES action_version (action_id, version)
) STRICT, WITHOUT ROWID;
CREATE INDEX action_play_played ON action_play (played_action_id);
INSERT OR IGNORE INTO action_play
    SELECT action_id, version, played_action_id FROM action_step WHERE played_action_id IS NOT NULL;

-- The tags of actions in force.
CREATE TABLE action_tag (
    tag       TEXT    NOT NULL,
    action_id INTEGER NOT NULL REFERENCES action (id),
    PRIMARY KEY (tag, action_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX action_tag_action ON action_tag (action_id);

-- The words of actions in force; the row is the action's.
CREATE VIRTUAL TABLE action_words USING fts5 (
    name, description, tags, words,
    content = '', contentless_delete = 1, tokenize = 'unicode61 remove_diacritics 2'
);
