-- Everybody on a circle that turns: rotating_circle.lua [STEPS]. Wants fleet.assignment: in_order.
local Fleet = require("roundabout")
local steps = tonumber(arg[1]) or 12
local RADIUS_M, STEP_DEG = 1.6, 30

local function circle(count, turned_deg)
  local points = {}
  for i = 1, count do
    local angle = math.rad(turned_deg + 360 * (i - 1) / count)
    points[i] = {RADIUS_M * math.cos(angle), RADIUS_M * math.sin(angle), 1.0}
  end
  return points
end

local fleet = Fleet.new()
fleet:take_off()
local count = #fleet:states()
for step = 0, steps - 1 do
  fleet:formation(circle(count, step * STEP_DEG), {name = "circle"})
  print(string.format("turned by %d degrees", step * STEP_DEG))
end
fleet:land()
