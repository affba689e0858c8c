--[[
Fly a fleet from a script.

    local Fleet = require("roundabout")
    local fleet = Fleet.new()
    fleet:take_off()
    fleet:spell("HI")
    fleet:land()

Frames are those of Roundabout: metres, z up, x and y span the floor. Every verb waits until the fleet has done it; with
{wait = false} it returns as soon as the fleet has taken it, and what comes next queues behind it. What the fleet refuses is
raised as an error whose `kind` is "refused" and whose `reason` is the fleet's own; other kinds are "lost" (the fleet is not
heard), "forgot" (it was restarted), "failed" (it gave up and lands) and "timeout" (the script's own limit has passed).
Over liblcm-lua.
]]

unpack = unpack or table.unpack -- what lcm-gen writes is for Lua 5.1

local lcm = require("lcm")
local fleet_status_t = require("roundabout_msgs.fleet_status_t")
local mission_t = require("roundabout_msgs.mission_t")
local safety_order_t = require("roundabout_msgs.safety_order_t")
local vehicle_states_t = require("roundabout_msgs.vehicle_states_t")

local DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
local NAN = 0 / 0
local FAILED, HOLD = 7, 4
local PHASES = {[0] = "waiting", "idle", "take_off", "go", "hold", "land", "done", "failed"}

local Problem = {}
Problem.__index = Problem
Problem.__tostring = function(problem)
  return problem.kind .. ": " .. problem.reason
end

local function raise(kind, reason)
  error(setmetatable({kind = kind, reason = reason}, Problem), 0)
end

local Fleet = {}
Fleet.__index = Fleet

--- url: default LCM_DEFAULT_URL, else LCM's default group on this machine only. Raises "lost" if no fleet speaks.
function Fleet.new(url)
  local self = setmetatable({}, Fleet)
  self.patience_s = 3 -- of wall clock without a word of the fleet
  self.status = nil -- the last fleet_status_t
  self._statuses = 0
  self._heard_at = os.time()
  self._last_id = 0
  self._asked = 0 -- the last id that is flown
  self._lcm = lcm.lcm.new(url or os.getenv("LCM_DEFAULT_URL") or DEFAULT_URL)
  self._lcm:subscribe("FLEET_STATUS", function(_, data)
    local good, status = pcall(fleet_status_t.decode, data)
    if good then -- a damaged one is followed by others
      self.status, self._statuses, self._heard_at = status, self._statuses + 1, os.time()
    end
  end)
  self._lcm:subscribe("VEHICLE_STATES", function(_, data)
    self._states = data
  end)
  while not self.status do
    self:_listen()
  end
  return self
end

function Fleet:_listen()
  self._lcm:timedhandle(50)
  -- os.time() counts whole seconds.
  if os.time() - self._heard_at > self.patience_s + 1 then
    raise("lost", "the fleet is not heard; vehicles stay at their goals")
  end
end

function Fleet:_refusal(mission)
  local prefix = string.format("mission %.0f: ", mission)
  for _, line in ipairs(self.status.refusals) do
    if line:sub(1, #prefix) == prefix then
      return line:sub(#prefix + 1)
    end
  end
end

function Fleet:_wait(done, mission, timeout)
  local deadline = os.time() + timeout
  while true do
    local refusal = self:_refusal(mission)
    if refusal then
      raise("refused", refusal)
    elseif self.status.phase == FAILED then
      raise("failed", self.status.reason)
    elseif done() then
      return
    elseif self.status.newest_mission_id < mission then
      raise("forgot", "the fleet was restarted; vehicles stay at their goals")
    elseif os.time() > deadline then
      raise("timeout", "not done in time; the fleet is in phase " .. self:phase())
    end
    self:_listen()
  end
end

function Fleet:_do(verb, values, options)
  options = options or {}
  local message = mission_t:new()
  -- Lua has no clock finer than a second: ids count on within it.
  self._last_id = math.max(os.time() * 1000000, self._last_id + 1, self.status.newest_mission_id + 1)
  message.utime, message.mission_id, message.verb = self._last_id, self._last_id, verb
  message.text = values.text or ""
  message.vehicle = values.vehicle or ""
  message.seconds = values.seconds or options.seconds or NAN
  message.points = values.points or {}
  message.num_points = #message.points
  self._lcm:publish("MISSION", message:encode())
  local deadline = os.time() + self.patience_s
  while self.status.newest_mission_id < self._last_id and not self:_refusal(self._last_id) do
    if os.time() > deadline then
      raise("lost", "the fleet does not take the mission")
    end
    self:_listen()
  end
  local refusal = self:_refusal(self._last_id)
  if refusal then
    raise("refused", refusal)
  end
  if verb ~= "go_on" then
    self._asked = self._last_id
  end
  if options.wait ~= false then
    self:wait_until_done(self._last_id, options.timeout)
  end
  return self._last_id
end

--- Everybody climbs to its height above its place.
function Fleet:take_off(options) return self:_do("take_off", {}, options) end
--- Everybody descends where it is, at once; what is queued is dropped.
function Fleet:land(options) return self:_do("land", {}, options) end
--- Everybody stays where it is, at once; what is queued is dropped.
function Fleet:hold(options) return self:_do("hold", {}, options or {wait = false}) end
--- Nothing changes for so many seconds of data time.
function Fleet:wait(seconds, options) return self:_do("wait", {seconds = seconds}, options) end
--- Nothing changes until what: "formed", "go_on" (somebody says it), or seconds since the take-off began.
function Fleet:wait_until(what, options)
  options = options or {timeout = 3600}
  return self:_do("wait_until", type(what) == "string" and {text = what} or {seconds = what}, options)
end
--- Ends a wait_until("go_on"), whoever asked for it.
function Fleet:go_on() return self:_do("go_on", {}, {wait = false}) end
--- Letter by letter; options.seconds: how long each is held.
function Fleet:spell(text, options) return self:_do("spell", {text = text}, options) end
--- A vehicle goes to each point {x, y, z}; options: name, seconds (default 0).
function Fleet:formation(points, options)
  options = options or {}
  local values = {points = points, text = options.name or "formation", seconds = options.seconds or 0}
  return self:_do("formation", values, options)
end
--- One vehicle goes to a point {x, y, z}.
function Fleet:go_to(vehicle, point, options) return self:_do("go_to", {vehicle = vehicle, points = {point}}, options) end

function Fleet:_order(kind, vehicle)
  local message = safety_order_t:new()
  message.utime, message.vehicle, message.order = os.time() * 1000000, vehicle or "", kind
  for _ = 1, 5 do -- planners take a repeated order for one
    self._lcm:publish("SAFETY_ORDER", message:encode())
    self._lcm:timedhandle(20)
  end
end

--- Motors off, now: of one vehicle, or of all. Whatever flies falls.
function Fleet:emergency(vehicle) self:_order(2, vehicle) end
--- Lifts what an operator has ordered.
function Fleet:resume(vehicle) self:_order(3, vehicle) end

--- The newest states: a list of vehicle_state_t, each also by its name.
function Fleet:states()
  local good, frame = false, nil
  while not good do -- a damaged one is followed by others
    self._states = nil
    while not self._states do
      self:_listen()
    end
    good, frame = pcall(vehicle_states_t.decode, self._states)
  end
  local states = {}
  for i, vehicle in ipairs(frame.vehicles) do
    states[i] = vehicle
    states[vehicle.name] = vehicle
  end
  return states
end

--- "idle", "go", "hold" and so on, as the fleet said last.
function Fleet:phase() return PHASES[self.status.phase] end

--- Until a mission (default: what was asked for last) is done.
function Fleet:wait_until_done(mission, timeout)
  mission = mission or self._asked
  self:_wait(function() return self.status.finished_mission_id >= mission end, mission, timeout or 120)
end

--- Until the formation (default: what was asked for last) is formed; it may be held for longer.
function Fleet:wait_until_formed(mission, timeout)
  mission = mission or self._asked
  self:_wait(function()
    local formed = self.status.mission_id == mission and self.status.phase == HOLD
    return formed or self.status.finished_mission_id >= mission
  end, mission, timeout or 120)
end

return Fleet
