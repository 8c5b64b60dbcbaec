-- The eye file, version 1: one SQLite file for the life of an eye. Blobs are little-endian, without padding; hashes are
-- XXH3 of 64 bits over everything else that a row says (record_digest.hpp), so that what was damaged is never believed.
-- A change that older programs cannot read raises user_version.
PRAGMA application_id = 0x43455945;  -- "CEYE"
PRAGMA user_version = 1;

CREATE TABLE eye(
  id INTEGER PRIMARY KEY CHECK (id = 1),
  serial TEXT NOT NULL,
  lattice TEXT NOT NULL,
  ommatidia_rows INTEGER NOT NULL,
  ommatidia_columns INTEGER NOT NULL,
  interommatidial_rad REAL NOT NULL,
  acceptance_rad REAL NOT NULL,
  radius_mm REAL NOT NULL,
  lens_height_mm REAL NOT NULL,
  pitch_mm REAL NOT NULL,
  image_rows INTEGER NOT NULL,
  image_cols INTEGER NOT NULL,
  plane_width_mm REAL NOT NULL,
  plane_height_mm REAL NOT NULL,
  plane_distance_mm REAL NOT NULL,
  hash INTEGER NOT NULL
) STRICT;

CREATE TABLE session(
  id INTEGER PRIMARY KEY,
  serial TEXT NOT NULL,
  firmware TEXT NOT NULL,
  config_id INTEGER NOT NULL,
  configuration TEXT NOT NULL,
  pattern_generator TEXT NOT NULL,
  seed INTEGER NOT NULL,
  plan TEXT NOT NULL,
  program TEXT NOT NULL,
  bits INTEGER NOT NULL,
  distance_mm REAL NOT NULL,
  started_unix_s INTEGER NOT NULL,
  captures INTEGER,                -- how many there are, and
  raw_hash INTEGER,                -- the hash over their hashes: NULL until the session has ended
  hash INTEGER NOT NULL
) STRICT;

-- Committed one by one, before the next pattern is shown.
CREATE TABLE capture(
  id INTEGER PRIMARY KEY,
  session INTEGER NOT NULL REFERENCES session(id),
  position INTEGER NOT NULL,       -- 0, 1, 2 ... in its session, without a gap
  stage TEXT NOT NULL,
  family TEXT NOT NULL,
  seed INTEGER NOT NULL,
  pattern INTEGER NOT NULL,
  repeat INTEGER NOT NULL,
  frames INTEGER NOT NULL,
  device_ns INTEGER NOT NULL,
  exposure_s REAL,
  temperature_c REAL,
  flags INTEGER NOT NULL,          -- 1 overrun, 2 saturated, 4 dark, 8 time ok
  valid BLOB NOT NULL,             -- a byte a channel, 0: its code means nothing; empty: all are valid
  codes BLOB NOT NULL,             -- int32 a channel, the sum over the frames
  hash INTEGER NOT NULL,
  UNIQUE (session, position)
) STRICT;

-- One estimate and all that belongs to it are one transaction.
CREATE TABLE estimate(
  id INTEGER PRIMARY KEY,
  parent INTEGER REFERENCES estimate(id),
  made_unix_s INTEGER NOT NULL,
  program TEXT NOT NULL,
  method TEXT NOT NULL,
  plan TEXT NOT NULL,
  distance_mm REAL NOT NULL,
  raw_hash INTEGER NOT NULL,       -- over the hashes of all captures of its sessions
  ommatidia INTEGER NOT NULL,      -- M
  pixels INTEGER NOT NULL,         -- N
  image_rows INTEGER NOT NULL,     -- 0 x 0: not known
  image_cols INTEGER NOT NULL,
  dense INTEGER NOT NULL,          -- 1: a block has no columns, its rows hold every pixel
  entries INTEGER NOT NULL,
  status BLOB NOT NULL,            -- a byte a channel: hal::ChannelStatus
  residual_pitch_px REAL NOT NULL,
  residual_counts BLOB NOT NULL,   -- int32 a row
  residual BLOB NOT NULL,          -- float32, row after row
  hash INTEGER NOT NULL            -- also over the tables below
) STRICT;

CREATE TABLE estimate_session(
  estimate INTEGER NOT NULL REFERENCES estimate(id),
  session INTEGER NOT NULL REFERENCES session(id),
  PRIMARY KEY (estimate, session)
) STRICT, WITHOUT ROWID;

-- Kinds: shared (parameters of all rows), kappa, sensor (EMVA 1288). NULL: not determined.
CREATE TABLE estimate_number(
  estimate INTEGER NOT NULL REFERENCES estimate(id),
  kind TEXT NOT NULL,
  place INTEGER NOT NULL,
  name TEXT NOT NULL,
  value REAL,
  PRIMARY KEY (estimate, kind, place)
) STRICT, WITHOUT ROWID;

-- Kinds: parameter (a number a row), sensor (EMVA 1288, a number a channel), channel (dark_level_lsb, chi2), linearity
-- (codes: K of them; values: K a channel). float64; NaN: not determined.
CREATE TABLE estimate_column(
  estimate INTEGER NOT NULL REFERENCES estimate(id),
  kind TEXT NOT NULL,
  place INTEGER NOT NULL,
  name TEXT NOT NULL,
  numbers BLOB NOT NULL,
  PRIMARY KEY (estimate, kind, place)
) STRICT;

-- Rows of the response, many to a block, so that a large eye loads in large pieces.
CREATE TABLE response_block(
  estimate INTEGER NOT NULL REFERENCES estimate(id),
  first_row INTEGER NOT NULL,
  entry_counts BLOB NOT NULL,      -- int32 a row
  columns BLOB NOT NULL,           -- int32 an entry, ascending in a row
  entries BLOB NOT NULL,           -- float32
  sigmas BLOB NOT NULL,            -- float32 an entry; empty: not known
  hash INTEGER NOT NULL,
  PRIMARY KEY (estimate, first_row)
) STRICT;
