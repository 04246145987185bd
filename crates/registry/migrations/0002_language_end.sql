-- Schema 2, second part: what the texts have replaced goes.
DROP TABLE step_primitive;
DROP TABLE action_step;

CREATE INDEX action_content_hash ON action (content_hash);

CREATE TRIGGER action_version_update
    BEFORE UPDATE OF action_id, version, saved_ms, description, tags, source ON action_version
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER action_play_update BEFORE UPDATE ON action_play
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
CREATE TRIGGER action_play_delete BEFORE DELETE ON action_play
    BEGIN SELECT RAISE(ABORT, 'versions are kept as saved'); END;
