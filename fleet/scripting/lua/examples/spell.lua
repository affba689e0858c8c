-- Spells a word: spell.lua [WORD]
local Fleet = require("roundabout")
local word = arg[1] or "HI"

local fleet = Fleet.new()
fleet:take_off()
for letter in word:gmatch(".") do
  fleet:spell(letter, {seconds = 1})
  print(letter .. " is formed")
end
fleet:land()
