-- The first vehicle leads along a square, each other one follows to where the one before it was: follow_leader.lua [STEPS].
-- Wants fleet.assignment: in_order, so that points go to vehicles in the order of the experiment file.
local Fleet = require("roundabout")
local steps = tonumber(arg[1]) or 8
local STEP_M, HEIGHT_M = 1.3, 1.0
local WAYS = {{1, 0}, {1, 0}, {0, 1}, {0, 1}, {-1, 0}, {-1, 0}, {0, -1}, {0, -1}}

local fleet = Fleet.new()
fleet:take_off()
local leader = fleet:states()[1].name
local places = {}
for i = 1, #fleet:states() do
  places[i] = {-(i - 1) * STEP_M, 0.0, HEIGHT_M}
end
fleet:formation(places, {name = "line"})
for step = 1, steps do
  local way, first = WAYS[(step - 1) % #WAYS + 1], places[1]
  table.insert(places, 1, {first[1] + way[1] * STEP_M, first[2] + way[2] * STEP_M, HEIGHT_M})
  table.remove(places)
  fleet:formation(places, {name = "follow"})
  local at = fleet:states()[leader].position
  print(string.format("%s leads at (%.1f, %.1f)", leader, at[1], at[2]))
end
fleet:land()
