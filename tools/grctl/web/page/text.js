// SPDX-License-Identifier: MIT
// The page in other languages: English text is the key. {0}, {1} are filled in.

import { JA_MAKE } from './make_text.js';

export const JA = {
    ...JA_MAKE,
    'Figure of the robot': 'ロボットの図', 'What the colours show': '色の意味', Torque: 'トルク', Heat: '温度',
    Current: '電流', Limits: '可動範囲', 'Show the whole robot': '全体を表示',
    'Drag or arrow keys: turn. Pinch, wheel, + and -: zoom. 0: whole robot. Tap a joint to choose it.':
        'ドラッグまたは矢印キー: 回転。ピンチ、ホイール、+ と -: 拡大縮小。0: 全体。関節をタップ: 選択。',
    Queue: '次に再生', 'End softly': '滑らかに終了', Loop: 'くり返し', Mirror: '左右反転', Speed: '速さ',
    'Position in the motion': 'モーションの位置', Views: '表示', See: '状態', Play: '再生', Joints: '関節',
    More: 'その他', 'Last minute': '直近 1 分', 'Add a joint to the plots': 'グラフに関節を追加',
    'Add a joint …': '関節を追加…', 'Remove {0} from the plots': '{0} をグラフから外す', Line: '通信',
    'Go to the initial pose': '初期姿勢へ', 'Torque on': 'トルクを入れる', 'Torque off': 'トルクを切る',
    'Tap a joint of the figure, or add one here, to see its last minute.':
        '図の関節をタップするか、ここで追加すると、直近 1 分が表示されます。',
    Joint: '関節', Angle: '角度', Target: '目標', 'Your name, for the others': '名前 (ほかの人に表示)',
    Language: '言語', Appearance: '外観', 'As the system': 'システムに合わせる', Dark: '暗い', Light: '明るい',
    'If this page is lost, a motion': 'このページとの接続が切れたら、モーションは',
    'stops softly and holds': '滑らかに止まり、姿勢を保つ', 'goes on to its end': '最後まで続ける',
    'ends as the exit policy says': '終了時の動作に従う', Keys: 'キー', 'STOP, at any time': 'いつでも STOP',
    Space: 'スペース', 'pause a motion that plays': '再生中のモーションを一時停止', views: '表示の切り替え',
    'on a slider: one step; on the figure: turn it': 'スライダー: 1 段。図: 回転',
    "on a joint's slider: 10 degrees": '関節のスライダー: 10 度', 'What happened': '記録',
    'Release the stop': '停止を解除',
    'Software stop: the joints stop and hold. The switch is on the robot.':
        'ソフトウェアによる停止です。関節は止まって姿勢を保ちます。電源スイッチはロボット本体にあります。',
    'The robot': 'ロボット',
    'Angle and target': '角度と目標', Temperature: '温度', Voltage: '電圧', 'no joint chosen': '関節が未選択',
    now: '今', right: '右足', left: '左足', Balance: 'バランス', unknown: '不明',
    '✕ {0} mm outside': '✕ {0} mm 外側', '✓ {0} mm inside': '✓ {0} mm 内側', 'Stands on': '支持',
    nothing: 'なし', Hottest: '最高温度', Tilt: '傾き',
    '✕ {0}°, fallen': '✕ {0}°、転倒', Supply: '電源電圧', '{0} ({1} in the last minute)': '{0} (直近 1 分 {1})',
    Load: '負荷', Readings: '読み取り', Budget: '上限', '{0} Hz watched, {1} Hz at most':
        '監視あり {0} Hz、最大 {1} Hz', Jitter: 'ゆらぎ', 'no motion yet': 'まだ再生なし',
    'Late frames': '遅れたフレーム', '{0} of {1}': '{1} 中 {0}', Timeouts: 'タイムアウト', Retries: '再試行',
    'Bad checksums': 'チェックサム誤り', Pages: 'ページ',
    'Without torque the robot sinks or falls. Hold it. Switch torque off?':
        'トルクを切るとロボットは崩れるか倒れます。手で支えてください。トルクを切りますか?',
    Limp: '脱力', Hold: '保持', Plot: 'グラフ', '{0}, degrees': '{0} (度)', '{0}, degrees a second': '{0} (度/秒)', 'at its limit': '限界',
    'not set up': '未設定', '{0}: not set up: {1}': '{0}: 未設定: {1}',
    limp: '脱力', on: '入', off: '切', brake: 'ブレーキ', 'No motions in {0}.': '{0} にモーションがありません。',
    '… being checked': '… 検査中', '✕ not readable': '✕ 読めません',
    'for another robot, cannot be played': '別のロボット用のため再生できません', '▲ falls at {0} s': '▲ {0} 秒で転倒',
    '▲ {0} warnings': '▲ 警告 {0} 件', '✓ checked': '✓ 検査済み', 'would fall at {0} s': '{0} 秒で転倒する',
    preview: 'プレビュー', '{0} of {1} seconds': '{1} 秒中 {0} 秒', idle: '待機', approaching: '開始姿勢へ',
    playing: '再生中', paused: '一時停止中', stopping: '終了中', finished: '終了', failed: '失敗',
    'preview, the robot does not move': 'プレビュー (ロボットは動きません)', 'ghost only': '影だけ',
    ready: '準備完了', Resume: '再開', Pause: '一時停止', Preview: 'プレビュー', loop: 'くり返し',
    mirrored: '左右反転', 'then {0}': '次: {0}', '▲ would fall at {0} s': '▲ {0} 秒で転倒します',
    '✓ stays within limits and balance': '✓ 可動範囲とバランスに問題なし', 'falls at {0} s': '{0} 秒で転倒',
    simulator: 'シミュレータ', 'This page does not drive any more.': 'このページの操作権がなくなりました。',
    'No connection to the server.': 'サーバに接続できません。', Phone: 'スマホ', Computer: 'パソコン',
    'No fresh news of the robot.': 'ロボットの最新の状態がありません。',
    'A stop is latched: release it first.': '停止中です。先に解除してください。',
    'Take control to move the robot.': '動かすには操作権を取ってください。',
    'This page drives.': 'このページが操作します。', '{0}° beyond': '{0}° 超過', '{0}° left': '残り {0}°',
    'connecting …': '接続中…', 'no news for {0} s': '{0} 秒間応答なし', 'robot lost': 'ロボットと通信不能',
    'opening the line …': '通信を開始中…', live: '接続中', 'You drive': 'あなたが操作中', '{0} drives': '{0} が操作中',
    'Nobody drives': '操作者なし', 'Give back': '操作権を返す', 'Take control': '操作権を取る',
    'Ask for control': '操作権を頼む', 'Asked …': '依頼中…', 'Asked, {0} s': '依頼中 {0} 秒',
    'Take over': '操作を引き継ぐ', '{0} asks to drive': '{0} が操作を希望', 'Give it': 'ゆずる',
    Yes: 'はい', No: 'いいえ', watching: '閲覧のみ', 'To drive, open the link that grctl serve printed.':
        '操作するには grctl serve が表示したリンクを開いてください。', 'Keep it': '続ける', free: '余裕あり',
    'less than 12° left': '残り 12° 未満', 'less than 3° left': '残り 3° 未満',
    'centre of mass': '重心', support: '支持多角形', target: '目標',
    'STOP sent, no answer for {0} s: use the switch on the robot':
        'STOP を送信、{0} 秒間応答なし: ロボット本体のスイッチを切ってください',
    'STOP sent': 'STOP を送信', 'Safety stop: {0}': '安全停止: {0}', 'Stopped by {0}': '{0} が停止',
    Stopped: '停止', 'all {0} joints stand or have no torque, read back':
        '全 {0} 関節の静止または脱力を確認', 'all {0} joints stand, read back': '全 {0} 関節の静止を確認',
    '{0} of {1} joints stand': '{1} 関節中 {0} が静止', stopped: '静止', moving: '動作中', silent: '応答なし',
    sent: '送信済み', over_temperature: '過熱', servo_overheated: 'サーボ過熱', over_current: '過電流',
    low_voltage: '電圧低下', lost_replies: '応答なし', torque_lost: 'トルク喪失',
    outside_limits: '可動範囲外', not_a_number: '不正な値', host_stalled: 'ホスト停止',
    emergency_stop: '非常停止', servos_apart: 'サーボの不一致',
    joint_blocked: '関節の拘束', joint_overloaded: '関節の過負荷', stop: '停止',
    // the fleet
    Fleet: 'フリート', Robots: 'ロボット', 'Name, host, model or motion': '名前、ホスト、機種、モーション',
    Group: 'グループ', 'Trouble only': '異常のみ', Close: '閉じる', 'Open its cockpit': 'コックピットを開く',
    'STOP all': 'すべて STOP',
    'Stops all robots, also those that the filter hides. Over a network a stop may come late or never: the switches are on the robots.':
        '絞り込みで隠れているものも含め、全ロボットを停止します。ネットワーク経由の停止は遅れたり届かないことがあります。電源スイッチは各ロボットにあります。',
    'signed off': '退出', 'agent lost': 'エージェント消失', 'no news': '応答なし', 'not connected': '未接続', moves: '動作中',
    'STOP sent, no answer for {0} s: use the switches':
        'STOP を送信、{0} 秒間応答なし: 各ロボットのスイッチを切ってください',
    'emergency stop': '非常停止', 'all {0} robots stand': '全 {0} 台の停止を確認',
    '{0} of {1} robots stand': '{1} 台中 {0} 台が停止', 'use its switch': '本体のスイッチを切ってください',
    '{0} joints, {1} is the nearest to a limit: {2}°': '{0} 関節、限界に最も近いのは {1}: {2}°',
    '{0} joints, not read': '{0} 関節、未読', 'broker lost': 'ブローカと通信不能', 'every group': '全グループ',
    '{0} robots': '{0} 台', 'No robot is like that.': '該当するロボットがありません。',
    'No agent is at this broker.': 'このブローカにエージェントがいません。', State: '状態', Model: '機種',
    Groups: 'グループ', Motion: 'モーション', Heard: '最終受信', never: 'なし', '{0} s ago': '{0} 秒前',
};

/** What the codes of the interface are called where their own name would not do. */
const EN = {
    over_temperature: 'too hot', servo_overheated: 'servo overheated', over_current: 'current too high',
    low_voltage: 'voltage too low', lost_replies: 'servo silent', torque_lost: 'torque lost',
    outside_limits: 'outside its limits', not_a_number: 'not a number', host_stalled: 'host stalled',
    emergency_stop: 'emergency stop', servos_apart: 'servos of a joint disagree',
    joint_blocked: 'joint blocked', joint_overloaded: 'joint overloaded', sent: 'not read yet', moving: 'moves', right: 'right foot',
    left: 'left foot',
};

export function translate(lang, text, values = []) {
    const found = lang === 'ja' && JA[text] || EN[text] || text;
    return found.replace(/\{(\d)\}/g, (_, n) => values[n]);
}
