function love.conf(t)
    t.identity = "lockstep2d-push"
    t.window.title = "lockstep2d: push the crates"
    t.window.width, t.window.height = 800, 450
    t.modules.audio, t.modules.joystick, t.modules.physics, t.modules.sound = false, false, false, false
end
